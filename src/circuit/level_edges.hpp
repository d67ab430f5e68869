#pragma once
/// Whether a source is at one of two levels nearly all of the time: a gate signal, and not a ramp or a triangle.

#include "model/source_function.hpp"

namespace pwlsim::circuit {

/// The longest share of a repeating signal that its edges may take.
inline constexpr double longest_share_of_edges = 0.1;
/// The same for a signal with one edge or two, of the run: a step or a single pulse, and not a slow start.
inline constexpr double longest_share_of_a_step = 0.01;

/// Within a run from 0 to `stop` (infinite: no end is known): edges take no longer than that, and no edge lasts longer than the level
/// before it or behind it. True for a signal without edges of finite duration. The function takes two values or one at its corners.
[[nodiscard]] bool has_short_edges(const model::Pulse& pulse, double stop);
[[nodiscard]] bool has_short_edges(const model::Pwl& pwl, double stop);

}  // namespace pwlsim::circuit
