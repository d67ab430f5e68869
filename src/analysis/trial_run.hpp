#pragma once
/// A run that may be taken back: what it tells is kept until it has completed.

#include <cstddef>

#include "analysis/transient.hpp"

namespace pwlsim::analysis {

/// Rows, events and pieces of a trial are kept up to this size; a longer run passes them on and can no longer be taken back.
inline constexpr std::size_t trial_memory = std::size_t{1} << 25U;  ///< bytes

/// Runs `first`. Where it finds no solution, and has not passed on anything, all that it told is forgotten, and `second` runs in its place, with the remark that `why` makes of the answer
/// of the first.
[[nodiscard]] Simulate tried_first(Simulate first, Simulate second, std::function<engine::Remark(const engine::Answer&)> why);

}  // namespace pwlsim::analysis
