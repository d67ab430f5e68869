#pragma once
/// Entry points of the exact engine (matrix exponential, guaranteed events).

#include <memory>
#include <vector>

#include "base/diagnostic.hpp"
#include "engine/run.hpp"
#include "model/network.hpp"

namespace pwlsim::engine {

/// A network prepared for running: islands split, what nothing needs left out, states extracted. Opaque to callers.
class ExactModel;

/// Errors of structure (floating part, source loop, cutset, improper ports) go to `diagnostics`; then the result is null.
[[nodiscard]] std::shared_ptr<const ExactModel> prepare(const model::Network& network, Diagnostics& diagnostics);

/// Runs from 0 to request.stop and hands every row to `sink`.
[[nodiscard]] Answer run(const ExactModel& model, const Request& request, RowSink& sink);

/// The DC operating point.
[[nodiscard]] OperatingPoint operating_point(const ExactModel& model);

}  // namespace pwlsim::engine
