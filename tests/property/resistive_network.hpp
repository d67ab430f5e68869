#pragma once
/// A network of conductances, sources, shorts and ideal diodes at one instant, solved by trying every position of the diodes.
///
/// For a position (which diodes conduct), shorts, stiff sources and conducting diodes form a forest whose trees are nodes of one known
/// difference of potential; between the trees stands G e = b with the conductances alone, symmetric and diagonally dominant, which
/// star-mesh transformations solve without subtracting conductances. The current
/// of a conducting diode is what Kirchhoff's current law leaves on its edge of the forest. The position solves the network where no
/// conducting diode carries a negative current and no other a positive voltage:
///
///     0 ≤ i ⊥ −v ≥ 0.
///
/// Positions in which the conducting diodes close a loop, or a blocking one joins parts that nothing else ties together, are left out:
/// their solutions are unbounded in one direction at most, so that an end of them belongs to a position that is not left out.
/// Nothing of the program is used here: no waves, no reduction to the ports, no pivoting.

#include <Eigen/Dense>
#include <cstddef>
#include <vector>

namespace pwlsim::test {

/// As an index of a vector.
[[nodiscard]] inline std::size_t at(int i) { return static_cast<std::size_t>(i); }

class ResistiveNetwork {
 public:
  /// Where a current jumps, the potentials of a step h are impulses/h; more digits than double keep what is beside them.
  using Real = long double;

  /// Current conductance·v + offset from p to n.
  struct Conductance {
    int p = 0, n = 0;
    Real conductance = 0, offset = 0;
  };
  /// v(p) − v(n) = voltage.
  struct Rigid {
    int p = 0, n = 0;
    Real voltage = 0;
  };
  struct Diode {
    int p = 0, n = 0;
  };

  int nodes = 1;                          ///< with ground, which is 0
  std::vector<Conductance> conductances;  ///< a current source has the conductance 0
  std::vector<Rigid> rigid;               ///< of several in a loop the last is redundant
  std::vector<Diode> diodes;              ///< at most 20

  /// Bit d of a position: diode d conducts.
  using Position = unsigned;
  /// The potentials of all nodes in this position, or none where it does not solve the network. `slack`: what counts as zero, relative to the terms.
  [[nodiscard]] std::vector<Real> potentials(Position position, Real slack) const;

  /// Positions by their distance from `first`, up to and with the first that solves the network; `first` is then that one.
  [[nodiscard]] std::vector<Real> solve(Position& first, Real slack) const;

  [[nodiscard]] Position positions() const { return 1U << diodes.size(); }
};

}  // namespace pwlsim::test
