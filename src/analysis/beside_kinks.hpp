#pragma once
/// Derivatives on both sides of a kink at which events meet: exact ones a little beside it, extrapolated to it.
///
/// Where a parameter moves events apart that lie at one time here, the modes between them are others for larger than for smaller values. At p ± h and
/// p ± 2h, h = 1e-6·p, they are apart, and the derivative there is as exact as anywhere; 2·d(p ± h) − d(p ± 2h) is the one at p to h²·d″.

#include <functional>

#include "analysis/derivative_table.hpp"
#include "circuit/compile.hpp"

namespace pwlsim::analysis {

/// The deck with one parameter of `.sens`, moved by so much.
[[nodiscard]] circuit::Compiled moved_deck(const circuit::Compiled& compiled, std::size_t parameter, double by);

/// Replaces failures at kinks where both sides are found. `derivatives`: of a deck, without this.
void resolve_kinks(const circuit::Compiled& compiled, const std::function<DerivativeTable(const circuit::Compiled&)>& derivatives,
                   DerivativeTable& table);

}  // namespace pwlsim::analysis
