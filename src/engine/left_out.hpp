#pragma once
/// Parts that no saved signal needs: decides which of them run anyway, and reports the others. The same for every engine.

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "engine/run.hpp"
#include "model/islands.hpp"

namespace pwlsim::engine {

/// Whether an island may be without a solution, which is an error even if nothing reads it. Builds its dense model.
[[nodiscard]] bool must_run(const model::Island& island);

/// Names of the sources in the islands that are needed.
[[nodiscard]] std::set<std::string> running_sources(const std::vector<model::Island>& islands);

/// N-left-out with the elements of an island that is not needed, without those of `running`; nothing where there are no others.
[[nodiscard]] std::optional<Remark> left_out(const model::Island& island, const std::set<std::string>& running);

}  // namespace pwlsim::engine
