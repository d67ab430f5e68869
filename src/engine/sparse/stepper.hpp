#pragma once
/// One step of the method: SDIRK2 with γ = 1 − 1/√2 (Alexander, SIAM J. Numer. Anal. 14, 1977), L-stable and stiffly accurate.
///
/// With y = E z and K = y' the stages are
///    y(Z1) = y_n + γ h K1,   y(Z2) = y_n + (1 − γ) h K1 + γ h K2,   z_{n+1} = Z2,
/// each a solve with  E/(γ h) + G,  so that both share one factor, and the derivative at the end is K2. Loops of capacitors and sources need no reduction:
/// only y, charges and fluxes, is carried from step to step.
///
/// Error: the local error on z' = λ z is C h³ z''' with C = 3γ² − 2γ³ − 1/6, and the second divided difference of K0, K1, K2 (at 0, γh, h; K0 from the
/// step before) is γ z''' to leading order, K1's own error included. So (C/γ) h³ [K0, K1, K2], passed once through the factor, which
/// takes stiff parts out of it.

#include "engine/sparse/port_solver.hpp"
#include "engine/sparse/sources.hpp"

namespace pwlsim::engine::sparse {

inline constexpr double gamma_sdirk = 0.29289321881345247560;  // 1 − 1/√2

/// The solution at a time.
struct Point {
  double time = 0.0;
  std::vector<double> z;  ///< unknowns
  std::vector<double> y;  ///< E z
  std::vector<double> k;  ///< E z'
  std::vector<double> w;  ///< sources
  Position on;
};

/// Running maxima of the states, which errors are relative to.
class StateScale {
 public:
  /// `voltage`: of the sources; where everything starts at zero, it says what small is.
  StateScale(const Descriptor& descriptor, double voltage)
      : descriptor_(descriptor), largest_(descriptor.states().size(), 0.0), voltage_(voltage) {}
  void note(const std::vector<double>& z);
  /// The same for states given one by one.
  void note_values(const std::vector<double>& states);
  /// What an error of state i is relative to: its running maximum, that of `z` included, but not less than a thousandth of the largest
  /// node voltage or inductor current (which counts as a thousandth of that voltage over R0 at least).
  [[nodiscard]] double size(std::size_t i, const std::vector<double>& z) const;
  /// max over the states of |error| / size.
  [[nodiscard]] double norm(const std::vector<double>& error, const std::vector<double>& z) const;

 private:
  void take(std::size_t i, double value);

  const Descriptor& descriptor_;
  std::vector<double> largest_;
  double voltage_ = 0.0, current_ = 0.0;  ///< largest of all nodes, and of all inductors
};

class Stepper {
 public:
  Stepper(const Descriptor& descriptor, PortSolver& ports, const Sources& sources);

  struct Trial {
    Solved solved = Solved::yes;
    Point end;
    std::vector<double> stage;    ///< Z1
    std::vector<double> stage_k;  ///< K1
    double error = 0.0;           ///< by StateScale
  };
  /// One step from `from`. `frozen`: ports stay in their position whatever their signs.
  void sdirk2(const Point& from, double h, bool frozen, const StateScale& scale, Trial& trial);
  /// One implicit Euler step, of the same factor as an SDIRK2 step of h/γ.
  [[nodiscard]] Solved euler(const Point& from, double h, Point& end);
  /// ½ h (k_b − k_a) through the factor of an Euler step: its local error.
  [[nodiscard]] double euler_error(const Point& a, const Point& b, double h, const StateScale& scale);

 private:
  [[nodiscard]] Solved stage(double shift, const std::vector<double>& w, bool frozen, Position& on, std::vector<double>& z);

  const Descriptor& descriptor_;
  PortSolver& ports_;
  const Sources& sources_;
  std::vector<double> memory_, stage_w_;
};

}  // namespace pwlsim::engine::sparse
