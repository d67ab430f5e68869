#pragma once
/// Which modes that differ from a given one in one or two ports can continue from a state at all, by the conditions at the instant itself:
/// y = C x + D u with 0 ≤ u ⊥ y ≥ 0. It only rejects; the remaining modes must be built and verified.
///
/// Principal pivoting (Cottle, Pang, Stone 1992, §2.3) on the ports P of the active set J for which D_PP can be inverted gives w = q + M z: of P
/// w is u and z is y, of the others w is y and z is u, and in the mode z = 0. What u is at J without P, derivatives settle: these ports, and whom
/// their u reaches, are left open. A mode with the ports F flipped has w_F = 0: z_F = −M_FF⁻¹ q_F ≥ 0, and q + M_·F z_F ≥ 0.

#include <span>
#include <vector>

#include "lcp/principal_pivoting.hpp"
#include "model/index_set.hpp"
#include "model/system.hpp"

namespace pwlsim::model {

class StaticNeighbours {
 public:
  /// x: system.size() entries; `largest`: the largest |x| so far, against whose rounding x is good.
  StaticNeighbours(const System& system, const IndexSet& active, const double* x, double largest);

  [[nodiscard]] bool may_flip(int port) const;
  [[nodiscard]] bool may_flip(int first, int second) const;

 private:
  /// restricted: 0 ≤ w ⊥ z ≥ 0; switches stay as they are. Of J without P: those that reach nothing, and those that do, with all they reach.
  enum class Role : char { restricted, stays, settled_later, reached };

  void pivot_on_active(const System& system, const IndexSet& active);
  void pivot(const std::vector<int>& ports);
  [[nodiscard]] bool is_zero(int row, int column) const;
  [[nodiscard]] bool rest_allows(std::span<const int> flipped, const double* z, const double* z_tolerance) const;
  [[nodiscard]] Role role(int port) const { return role_[static_cast<std::size_t>(port)]; }

  [[nodiscard]] const Vector& q() const { return tableau_.q(); }
  [[nodiscard]] const linalg::Matrix& m() const { return tableau_.m(); }

  std::vector<Role> role_;
  lcp::PrincipalTableau tableau_;
  Vector tolerance_;     ///< rounding of q
  linalg::Matrix size_;  ///< sums of the magnitudes that the entries of M are sums of
};

}  // namespace pwlsim::model
