#pragma once
/// One step of a method, with  k = E z'  the rates:  k = −(G z + H w + g).
///
/// TR-BDF2 (Bank et al., IEEE Trans. Electron Devices 32, 1985; Hosea and Shampine, Appl. Numer. Math. 20, 1996) where nothing changes sides:
///    E (Z1 − z0) = d h (k0 + K1)  at 2 d h,    E (Z2 − z0) = h (b (k0 + K1) + d K2)  at h,    d = 1 − 1/√2,  b = √2/4.
/// L-stable, stiffly accurate, both stages with the factor of  E/(d h) + G,  and of stage order 2: K2 is the derivative of the parabola through z0, Z1, Z2,
/// so that currents of capacitors in loops with sources, which are derivatives, are of order 2 as all else. Its error is estimated by the method of
/// order 3 that shares its stages, once through the factor, which takes stiff parts out of it. The solution goes on without that error, taken through
/// the factor twice: of order 3 and, as before, A- and L-stable. (Once through the factor it would grow by 1.6 at infinity.)
///
/// SDIRK2 (Alexander, SIAM J. Numer. Anal. 14, 1977) for a step in which ports change sides: the same d and factor, stages at d h and h, and
/// no k0 in it, which is another's beyond the change. Its error from K2, K1 and k0, whose second divided difference is d z''' to leading order.

#include "engine/sparse/port_solver.hpp"
#include "engine/sparse/sources.hpp"

namespace pwlsim::engine::sparse {

inline constexpr double diagonal = 0.29289321881345247560;     // d = 1 − 1/√2
inline constexpr double step_weight = 0.35355339059327376220;  // b = √2/4
inline constexpr double first_stage = 2.0 * diagonal;          ///< of TR-BDF2, of the step

/// The solution at a time.
struct Point {
  double time = 0.0;
  std::vector<double> z;          ///< unknowns
  std::vector<double> k;          ///< E z'
  std::vector<double> k_sizes{};  ///< |E| |z'|, of which k has rounding; empty: it has none
  std::vector<double> w;          ///< sources
  Position on;
};

/// Running maxima of the states, which errors are relative to.
class StateScale {
 public:
  /// `voltage`: of the sources; where everything starts at zero, it says what small is. `counts_nodes`: what nodes have had says so too.
  StateScale(const Descriptor& descriptor, double voltage, bool counts_nodes = true)
      : descriptor_(descriptor), largest_(descriptor.states().size(), 0.0), voltage_(voltage), counts_nodes_(counts_nodes) {}
  void note(const std::vector<double>& z);
  /// The same for states given one by one.
  void note_values(const std::vector<double>& states);
  /// What an error of state i is relative to: its running maximum, that of `z` included, but not less than a thousandth of the largest
  /// voltage or inductor current (of which either counts as a thousandth of the other at least, by R0).
  [[nodiscard]] double size(std::size_t i, const std::vector<double>& z) const;
  /// max over the states of |error| / size.
  [[nodiscard]] double norm(const std::vector<double>& error, const std::vector<double>& z) const;

 private:
  void take(std::size_t i, double value);

  const Descriptor& descriptor_;
  std::vector<double> largest_;
  double voltage_ = 0.0, current_ = 0.0;  ///< largest of all nodes or capacitors, and of all inductors
  bool counts_nodes_;
};

class Stepper {
 public:
  Stepper(const Descriptor& descriptor, PortSolver& ports, const Sources& sources);

  struct Trial {
    Solved solved = Solved::yes;
    Point stage, end;    ///< Z1 and Z2
    double error = 0.0;  ///< by StateScale
  };
  /// One step of TR-BDF2, ports in their position whatever their signs.
  void tr_bdf2(const Point& from, double h, const StateScale& scale, Trial& trial);
  /// Right after a step of TR-BDF2: takes its estimated error out of its end, once more through the factor, so that stiff parts are damped as before.
  /// What is left is of the method of order 3.
  [[nodiscard]] Solved improve(double h, Trial& trial);
  /// One step of SDIRK2, ports where they belong, if Newton's method alone finds that.
  void sdirk2(const Point& from, double h, const StateScale& scale, Trial& trial);
  /// One implicit Euler step: of the factor of a step h/d. `more`: charges and fluxes beside E z, or none.
  [[nodiscard]] Solved euler(const Point& from, double h, Point& end, const std::vector<double>& more = {});

 private:
  /// One of the stages of a step from a point, whose rates come first.
  void start_from(const Point& from);
  [[nodiscard]] Solved stage(const Point& from, double shift, Search search, Point& at);
  void clear_inputs(Point& at);
  [[nodiscard]] double estimate(double shift, const Position& on, const StateScale& scale, const std::vector<double>& z);

  const Descriptor& descriptor_;
  PortSolver& ports_;
  const Sources& sources_;
  std::vector<double> rates_;   ///< −(G z0 + g)
  std::vector<double> memory_;  ///< m of a stage:  k = shift·E (z − z0) − m
  std::vector<double> right_, step_;
};

}  // namespace pwlsim::engine::sparse
