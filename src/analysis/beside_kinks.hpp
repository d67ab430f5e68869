#pragma once
/// Derivatives on both sides of a kink at which events meet: exact ones near it, extrapolated to it.
///
/// If a parameter separates events that coincide, the modes between them are different for larger and smaller values. At p ± h and
/// p ± 2h, h = 1e-6·p, the events are separate, and the derivative there is exact; 2·d(p ± h) − d(p ± 2h) is the one at p to h²·d″.

#include <functional>

#include "analysis/derivative_table.hpp"
#include "circuit/compile.hpp"

namespace pwlsim::analysis {

/// The deck with one parameter of `.sens` changed by this amount.
[[nodiscard]] circuit::Compiled moved_deck(const circuit::Compiled& compiled, std::size_t parameter, double by);

/// Replaces failures at kinks if both sides are found. `derivatives`: those of a deck, without this function.
void resolve_kinks(const circuit::Compiled& compiled, const std::function<DerivativeTable(const circuit::Compiled&)>& derivatives,
                   DerivativeTable& table);

}  // namespace pwlsim::analysis
