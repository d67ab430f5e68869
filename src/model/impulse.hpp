#pragma once
/// The impulses of a jump in one mode, of any order.
///
/// In mode J the Laplace transform û of the input has a polynomial part Σ u^{−j} s^{j−1}, j = 1 … L, with
///
///     x⁺ − x⁻ = Σ A^{j−1} B u^{−j},    y_J^m = Σ_{l ≤ m} M_{m−l} u^l = 0  for m = −L … −1,
///
/// M_0 = D, M_j = C A^{j−1} B (van der Schaft & Schumacher 1996, eq. (4.11), continued to negative indices).

#include <vector>

#include "model/index_set.hpp"
#include "model/system.hpp"

namespace pwlsim::model {

struct Impulse {
  int order = 0;  ///< L; 0: the jump is not one of the mode
  Vector weight;  ///< u^{−1}, that is ∫u dt of all ports, in u·s; where it is not unique, the least norm that the diodes allow
  std::vector<int>
      sign;  ///< of each diode port: of its first impulse that is not zero, highest order first; of u_i in J, of y_i outside; 0: none
};

/// `jump`: x⁺ − x⁻ (system.size()), with an error of norm `noise`; signs count only beyond the effect of that error. `rate`: linalg::rate_of(A).
[[nodiscard]] Impulse find_impulse(const System& system, double rate, const IndexSet& active, const Vector& jump, double noise);

}  // namespace pwlsim::model
