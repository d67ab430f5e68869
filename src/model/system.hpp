#pragma once
/// A linear complementarity system with sources in its state and with externally driven switches:
///
///     x' = A x + B u,   y = C x + D u,   x = (ξ, ζ),
///     ports 0 … diodes−1:        0 ≤ u ⊥ y ≥ 0   (first the network's diodes, then its complementarities; valves only while they are enabled),
///     ports diodes … ports−1:    u = 0 or y = 0, as its switch says,
///
/// ξ (n): energy coordinates, so that the stored energy is ½·τ0·|ξ|²/R0 for circuits; ζ (n_ζ): exosystem.
/// A is (n+n_ζ)², B has zero rows at ζ. Van der Schaft & Schumacher 1996, eq. (4.11)-(4.13).

#include <memory>
#include <string>
#include <vector>

#include "base/source.hpp"
#include "linalg/dense.hpp"
#include "model/exosystem.hpp"

namespace pwlsim::model {

using linalg::Matrix;
using linalg::Vector;

/// value = state·x + input·u, in SI units; over an instant ∫value dt = input·∫u dt + edge·Δζ.
struct OutputRow {
  Vector state;      ///< n + n_ζ
  Vector input;      ///< ports
  Vector edge = {};  ///< n_ζ: of capacitors across sources and inductors in series with them

  [[nodiscard]] bool reads_ports() const { return !input.isZero(0.0); }
};

struct Port {
  std::string name;
  SourceSpan span;
  /// true: u is the (scaled) current and y the blocking voltage; false: u the blocking voltage and y the current.
  bool input_is_current = false;
  double u_unit = 1.0, y_unit = 1.0;  ///< u and y in SI units (a complementarity: in its own) are these times u and y
  bool is_of_leak = false;            ///< Diode::is_of_leak: no report shows it
};

/// A voltage or current that drives switches, with the thresholds of each.
struct Control {
  OutputRow value;
  int driven = 0;  ///< number of the switch in the whole model
  double on_level = 0.0, off_level = 0.0;
};

/// A diode port that conducts only while one of these switch ports is closed; without any, never (valves.hpp).
struct Valve {
  int port = 0;
  std::vector<int> switches;
};

/// A, B, C, D before they are rounded to double.
struct Unrounded {
  linalg::WideMatrix a, b, c, d;
};

struct System {
  std::string name;  ///< of the island, for messages
  int n = 0;         ///< energy states
  int n_zeta = 0;
  int diodes = 0;
  int ports = 0;  ///< diodes + switches
  Matrix a, b, c, d;
  std::shared_ptr<const Unrounded> unrounded;  ///< empty for a system that was made in double
  Vector x0;                                   ///< start of ξ with uic (n)
  std::vector<Port> port;
  std::vector<int> switch_number;  ///< of port diodes + i: number of the switch in the whole model
  std::vector<char> switch_inverted;
  std::vector<Valve> valves;       ///< of the diodes, those that switches enable
  std::vector<Control> controls;   ///< guards that this island's signals feed, for switches of any island
  std::vector<Control> clocked;    ///< those of them that piecewise linear sources alone drive (clock.hpp); not in `controls`
  std::vector<OutputRow> outputs;  ///< signals this island contributes to
  std::vector<int> output_signal;  ///< their numbers in the model
  std::shared_ptr<const Exosystem> exosystem;
  bool passive = false;  ///< certified by the KYP inequality in energy coordinates
  double kyp_residual = 0.0;
  double time_scale = 1.0;  ///< τ0: the stored energy is ½·τ0·|ξ|² in the units in which uᵀy is a power

  [[nodiscard]] int size() const { return n + n_zeta; }
  /// Nothing but sources: runs evaluate them when they are read.
  [[nodiscard]] bool is_static() const { return n == 0 && ports == 0; }
  /// `unrounded`, or the rounded ones in its place.
  [[nodiscard]] std::shared_ptr<const Unrounded> unrounded_matrices() const {
    using linalg::Wide;
    return unrounded ? unrounded
                     : std::make_shared<const Unrounded>(Unrounded{a.cast<Wide>(), b.cast<Wide>(), c.cast<Wide>(), d.cast<Wide>()});
  }
};

}  // namespace pwlsim::model
