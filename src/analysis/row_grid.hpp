#pragma once
/// The times of the output rows of a `.tran` card.

#include "circuit/analyses.hpp"
#include "engine/run.hpp"

namespace pwlsim::analysis {

/// Row k is at start + k·step, formed exactly from the decimal text and rounded once; the last row is at stop, added if stop is
/// off the grid. A step of 0 means 1000 equal steps. A step from an expression (its decimal text is empty) is a rounded number:
/// a grid row less than one rounding error before stop is then stop itself, not a separate row.
[[nodiscard]] engine::RowGrid row_grid(const circuit::TransientAnalysis& transient);

}  // namespace pwlsim::analysis
