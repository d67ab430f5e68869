#pragma once
/// Markov parameters and what leads among them:  M_0 = D,  M_j = C A^{j−1} B  (van der Schaft & Schumacher 1996, §4.3).

#include <vector>

#include "linalg/dense.hpp"

namespace pwlsim::model {

struct Markov {
  /// M_0 … up to the largest order that leads a row or a column; at least M_0.
  std::vector<linalg::Matrix> parameters;
  /// degree[i][j]: the first order at which entry (i, j) is not zero; −1: zero at every order.
  std::vector<std::vector<int>> degree;
  /// ρ where M_0 … M_{ρ−1} vanish and M_ρ is nonsingular (uniform zeros at infinity of order ρ); −1: no such ρ.
  int uniform_degree = -1;
  /// Row i (column j) of the first parameter in which that row (column) is not zero, up to a positive factor; a row that is always zero stays zero.
  linalg::Matrix leading_rows, leading_columns;
};

/// A: n×n, B: n×k, C: k×n, D: k×k. Entries below 1e-14 of the terms that cancel in them count as zero.
[[nodiscard]] Markov markov_parameters(const linalg::Matrix& a, const linalg::Matrix& b, const linalg::Matrix& c, const linalg::Matrix& d);

/// Whether G(s) = D + C(sI−A)⁻¹B is a P-matrix for all large s: with leading rows of order ρ_i, det G_JJ(s) = s^{−Σρ_i}(det L_JJ + O(1/s)),
/// so it is where all principal minors of the leading rows, or of the leading columns, are positive. The rational complementarity problem
/// then has one solution from every state (for uniform zeros at infinity this is van der Schaft & Schumacher 1996, Theorem 4.1). k ≤ 20.
[[nodiscard]] bool has_positive_leading_minors(const Markov& markov);

}  // namespace pwlsim::model
