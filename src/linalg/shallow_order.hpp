#pragma once
/// An order of columns in which few columns of L and U depend on each.
///
/// With whatever pivots, the columns that one of L and U depends on are among those of the Cholesky factor of AᵀA (George and Ng, SIAM J. Sci. Stat. Comput. 8, 1987). The next column is
/// the one with the fewest neighbours there that are left, plus its depth, the longest chain of columns that depend on each other and end with it (Betancourt, IEEE Trans. Power
/// Systems 3(3), 1988, "minimum degree, minimum length"): where a chain of a thousand cells fills nothing if it is eliminated from one end to the other, its last column depends on
/// all of them; by halves of halves it depends on a few dozen, and entries are a quarter more.

#include <optional>
#include <vector>

#include "linalg/sparse.hpp"

namespace pwlsim::linalg {

/// Columns of a square pattern, by place. Nothing where the search takes more than some hundred operations for each entry.
[[nodiscard]] std::optional<std::vector<int>> shallow_order(const SparsePattern& pattern);

}  // namespace pwlsim::linalg
