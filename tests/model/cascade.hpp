#pragma once
/// Mode selection by a cascade of linear complementarity problems (van der Schaft & Schumacher 1996, §3 and §4.3, after Lötstedt 1982).
///
/// With x' = A x + B u, y = C x + D u and the Markov parameters M_0 = D, M_j = C A^{j−1} B, the coefficients of
/// û(s) = Σ u^l s^{−l−1} and ŷ(s) = Σ y^j s^{−j−1} obey, eq. (4.11),
///
///     y^j = C A^j x + Σ_{l ≤ j} M_{j−l} u^l                                  (C A^j x only for j ≥ 0).
///
/// Let ρ_i be the leading row index of port i, the least j with row i of M_j not zero, and N the matrix of those leading rows. (Uniform ρ: N is the
/// decoupling matrix L_g L_f^{ρ−1} h of eq. (3.18), the leading Markov parameter M_ρ.) Then y_i^{ρ_i+l} = z_i^l + N_i u^l with z^l known from
/// the steps before, which is eq. (3.22), and step l is, with I, J, K the active, inactive and undetermined indices so far, eq. (3.25)–(3.29),
///
///     y_I = 0,  u_J = 0,  0 ≤ u_K ⊥ y_K = z_K − N_KI N_II⁻¹ z_I + (N_KK − N_KI N_II⁻¹ N_IK) u_K ≥ 0
///
/// (the first minus is a plus in the print of eq. (3.29); eq. (3.25) gives the minus).
///
/// An index with u_i > 0 joins I, one with y_i > 0 joins J. What is still in K after all steps is indeterminate (Remark 3.6): every mode between I
/// and I ∪ K gives the same solution.
///
/// `smooth` (LDCP): l = 0, 1, … The coefficients y_i^0 … y_i^{ρ_i−1} do not depend on u; one that is negative after zeros means that no
/// smooth continuation exists, eq. (3.19). `impulsive`: l = −max ρ − 1, …; u^{−1}, u^{−2}, … are weights of impulses and their derivatives, and the
/// state jumps to x + Σ A^{j−1} B u^{−j}.
///
/// Where all principal minors of N are positive every step has one solution (Theorems 3.4, 4.1; for different ρ_i Heemels, Schumacher and
/// Weiland 2000). Where they are only not zero, every step has finitely many and all are followed. Where one that matters is zero, or N has a
/// zero row, the cascade does not apply and says `undecided`.

#include <vector>

#include "linalg/dense.hpp"
#include "model/index_set.hpp"

namespace pwlsim::model {

enum class Verdict {
  none,  ///< no solution
  unique,
  several,
  undecided  ///< N or a block of it is singular where it decides; what was found may not be all
};

/// One solution of the complementarity problem, as far as its indices are determined.
struct Continuation {
  IndexSet active, inactive, indeterminate;
  bool jumps = false;          ///< has impulses
  linalg::Vector state_after;  ///< x + Σ A^{j−1} B u^{−j}
};

struct CascadeOutcome {
  Verdict verdict = Verdict::none;
  std::vector<Continuation> continuations;
};

class Cascade {
 public:
  /// A: n×n, B: n×k, C: k×n, D: k×k. Where N is no P-matrix, or signs are close, all bases of a step are tried; beyond 2¹⁰ it is undecided.
  Cascade(const linalg::Matrix& a, const linalg::Matrix& b, const linalg::Matrix& c, const linalg::Matrix& d);

  /// `noise`: relative error of x; coefficients that it explains are zero.
  [[nodiscard]] CascadeOutcome smooth(const linalg::Vector& x, double noise) const;
  [[nodiscard]] CascadeOutcome impulsive(const linalg::Vector& x, double noise) const;

  /// All principal minors of N are positive: every x has one solution.
  [[nodiscard]] bool one_solution() const { return one_solution_; }

 private:
  friend class CascadeSteps;
  [[nodiscard]] CascadeOutcome solve(const linalg::Vector& x, double noise, bool impulsive) const;

  int n_, k_;
  linalg::Wide rate_;
  bool one_solution_ = false;
  linalg::WideMatrix a_, b_, c_;
  std::vector<linalg::WideMatrix> markov_;
  std::vector<int> row_index_;
  linalg::WideMatrix leading_rows_;
};

}  // namespace pwlsim::model
