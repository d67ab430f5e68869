#pragma once
/// The DC problem of a system as a complementarity problem of its ports alone, with every state held weakly at a given place x₀:
///
///     0 = A ξ + B u + e − ε (ξ − x₀),   y = C ξ + D u + f,   0 ≤ u ⊥ y ≥ 0.
///
/// It is one step of the proximal-point method, or of implicit Euler with the step 1/ε. In a passive system it has one ξ, which goes to the DC
/// state nearest to x₀ as ε → 0, and for small ε its active ports are those of that state: nothing here decides a rank.
///
/// In u and y the entries grow like 1/ε where capacitors block DC. In the waves of ports that are terminated in R0, y + u = −a and y − u = b,
/// they do not: b = S a + s with |S| ≤ 1 in a passive system. The signs Θ = diag(±1) of S + Θ, found greedily, choose of each port which of its
/// two is z, w − z = Θ b; (S + Θ) w = (Θ − S) z + s. Switches are given: their z is zero.

#include <vector>

#include "model/index_set.hpp"
#include "model/system.hpp"

namespace pwlsim::engine {

/// The set of active ports that holds the switches alone. `switch_active`: an entry for each switch port.
[[nodiscard]] model::IndexSet with_switches(const model::System& system, const std::vector<char>& switch_active);

class StaticPorts {
 public:
  StaticPorts(const model::System& system, const linalg::Vector& zeta);

  /// Of the slowest state with its ports terminated: in units of it, ε is small where it is small at all.
  [[nodiscard]] double slowest_rate() const { return slowest_rate_; }

  struct Proposal {
    std::vector<std::vector<int>> active;  ///< sets of ports with y = 0, the likelier first; none: no solution found
    double distance = 0.0;                 ///< |ξ − x₀|; in a passive system no DC state is nearer to x₀
  };
  /// `switch_active`: an entry for each switch port.
  [[nodiscard]] Proposal propose(double epsilon, const linalg::Vector& x0, const std::vector<char>& switch_active) const;

 private:
  struct Waves {
    linalg::WideMatrix s;
    linalg::WideVector s0;
    linalg::WideMatrix to_state;  ///< ξ = to_state·a + state0
    linalg::WideVector state0;
  };
  [[nodiscard]] Waves waves(double epsilon, const linalg::Vector& x0) const;

  const model::System& system_;
  linalg::WideMatrix a_, b_, c_, d_;  ///< of the terminated system: ξ' = a ξ + b·wave + e, y = c ξ + d·wave + f
  linalg::WideVector e_, f_;
  double slowest_rate_ = 1.0;
};

}  // namespace pwlsim::engine
