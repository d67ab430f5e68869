#pragma once
/// Entry points of the exact engine (matrix exponential, guaranteed events).

#include <memory>
#include <span>
#include <vector>

#include "base/diagnostic.hpp"
#include "engine/run.hpp"
#include "model/network.hpp"

namespace pwlsim::engine {

/// A network prepared for running: split into islands, without unneeded parts, states extracted. Opaque to callers.
class ExactModel;

/// Whether leaks that make a network stiff get their own ports (model/leaks.hpp), or the model is that of the network as written.
enum class Leaks { as_ports, as_written };

/// Errors of structure (floating part, source loop, cutset, improper ports) go to `diagnostics`; then the result is null.
[[nodiscard]] std::shared_ptr<const ExactModel> prepare(const model::Network& network, Diagnostics& diagnostics,
                                                        Leaks leaks = Leaks::as_ports);

/// The same model with other initial values of held sources, by channel: everything that does not depend on them is reused.
[[nodiscard]] std::shared_ptr<const ExactModel> with_held_values(const ExactModel& model, std::span<const double> values);

/// Runs from 0 to request.stop and passes every row to `sink`.
[[nodiscard]] Answer run(const ExactModel& model, const Request& request, RowSink& sink);

/// The DC operating point.
[[nodiscard]] OperatingPoint operating_point(const ExactModel& model);

}  // namespace pwlsim::engine
