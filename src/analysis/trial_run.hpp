#pragma once
/// A run that may be taken back: what it tells is kept until it has completed.

#include <cstddef>

#include "analysis/transient.hpp"

namespace pwlsim::analysis {

/// Rows, events and pieces of a trial are kept up to this size; a longer run passes them on and can no longer be taken back.
inline constexpr std::size_t trial_memory = std::size_t{1} << 25U;  ///< bytes

/// What runs in the place of a run with this answer; empty: the answer stands.
using Other = std::function<Simulate(const engine::Answer&)>;

/// Runs `first`. Where it has not passed on anything and `other` has something for its answer, all that it told is forgotten, and that runs in its place, with the remark that `why` makes of
/// the answer of the first.
[[nodiscard]] Simulate tried_first(Simulate first, Other other, std::function<engine::Remark(const engine::Answer&)> why);

/// The same, with `second` where the first finds no solution.
[[nodiscard]] Simulate tried_first(Simulate first, Simulate second, std::function<engine::Remark(const engine::Answer&)> why);

}  // namespace pwlsim::analysis
