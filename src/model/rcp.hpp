#pragma once
/// The rational complementarity problem (van der Schaft & Schumacher 1996, §4.3, problem RCP; û rational, not only strictly proper, as in Heemels,
/// Schumacher and Weiland 1999): with T(s) = C(sI − A)⁻¹ and G(s) = T(s) B + D,
///
///     ŷ(s) = T(s) x + G(s) û(s),   0 ≤ û(s) ⊥ ŷ(s) ≥ 0   for all sufficiently large s.
///
/// At a fixed s it is a linear complementarity problem, whose solution gives candidates for the mode. They must be verified: how large s must be
/// depends on x.

#include <cstdint>
#include <vector>

#include "model/index_set.hpp"
#include "model/port_problem.hpp"
#include "model/system.hpp"

namespace pwlsim::model {

class RationalProblem {
 public:
  explicit RationalProblem(const System& system);

  /// s·T(s) x and G(s) of all ports, by their series in 1/s. x: system.size() entries.
  [[nodiscard]] PortProblem at(const double* x, double s);
  /// Sets of the linear complementarity problem at s: by the values of its solution (ties as in `wanted`), then by its basis where that
  /// differs. Empty where it has no solution. The switch ports stay as in `wanted`.
  [[nodiscard]] std::vector<IndexSet> candidates(const double* x, double s, const IndexSet& wanted);

  /// Whether the problem has one solution for every x, with the switch ports as in `wanted`: G(s) is a P-matrix for all sufficiently
  /// large s (Heemels, Schumacher and Weiland 1999; Cottle, Pang, Stone 1992, Theorem 3.3.7), aside from ports that are others'
  /// twins, the other way round or not (what these share is not unique; x and their sum are), and from those that move nothing and
  /// are not moved. False if that is not so, is not certain, or would take too long to decide.
  [[nodiscard]] bool is_uniquely_solvable(const IndexSet& wanted);

  /// ‖A‖₂ (1 where A is zero): the unit in which s is large.
  [[nodiscard]] double rate() const { return rate_; }
  /// Pivots of all problems so far.
  [[nodiscard]] std::uint64_t pivots() const { return pivots_; }

 private:
  [[nodiscard]] Matrix port_matrix(double s);
  [[nodiscard]] Matrix effects(double s, std::vector<int> active);

  const System& system_;
  double rate_;
  std::vector<Matrix> markov_;  ///< C A^{j−1} B, j = 1 …
  std::uint64_t pivots_ = 0;
};

}  // namespace pwlsim::model
