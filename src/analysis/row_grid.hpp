#pragma once
/// The times of the output rows of a `.tran` card.

#include "circuit/analyses.hpp"
#include "engine/run.hpp"

namespace pwlsim::analysis {

/// Row k stands at start + k·step, formed exactly from the decimal text and rounded once; the last row stands at stop, added when stop is
/// off the grid. A step of 0 stands for 1000 equal steps. A step that an expression gave (its decimal text is empty) is a rounded number:
/// a grid row less than one rounding error before stop is then stop itself and not a row of its own.
[[nodiscard]] engine::RowGrid row_grid(const circuit::Transient& transient);

}  // namespace pwlsim::analysis
