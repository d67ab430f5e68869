#pragma once
/// Principal pivot transforms (Tucker 1963; Cottle, Pang, Stone, "The Linear Complementarity Problem", §2.3) and the methods that use them.
///
/// Exchanging the roles of z_α and w_α in w = M z + q, with M_αα nonsingular, gives w' = M' z' + q' with the same solutions. P-matrices stay
/// P-matrices and positive semidefinite ones stay so. A basis β of the transformed problem is the basis α Δ β of the original one, and
/// det M_(αΔβ) = det M_αα · det M'_ββ.

#include "lcp/problem.hpp"

namespace pwlsim::lcp {

class PrincipalTableau {
 public:
  PrincipalTableau(linalg::Matrix m, linalg::Vector q);

  [[nodiscard]] const linalg::Matrix& m() const { return m_; }
  [[nodiscard]] const linalg::Vector& q() const { return q_; }
  [[nodiscard]] const std::vector<char>& exchanged() const { return exchanged_; }
  [[nodiscard]] std::vector<int> basis() const;

  /// Exchanges z and w of `block` at once; M'_block must be nonsingular.
  void exchange(const std::vector<int>& block);

 private:
  linalg::Matrix m_;
  linalg::Vector q_;
  std::vector<char> exchanged_;
};

/// Murty's least-index method (1974; Cottle, Pang, Stone, Algorithm 4.2.2 ff.): exchanges the smallest index with w' < 0. Ends for every P-matrix,
/// without comparing ratios and hence without ties; in the worst case exponential, so it gives up after 20k + 200 pivots.
[[nodiscard]] Solution least_index(const linalg::Matrix& m, const linalg::Vector& q);

}  // namespace pwlsim::lcp
