#pragma once
/// Checks complementarity of every port on its own scale, over the whole run.
///
/// At the end of every segment (just before the event that ends it), and at rows and Chebyshev points inside segments that are long against their mode's time constants, each
/// port's u or y, whichever the mode leaves free, must not be below zero. An excess below zero, beyond the rounding of its own terms, is compared with the largest value of the same quantity in the run: a diode's voltage
/// with its own voltage, its current with its own current. A missed event shows here, because the guard continues below zero; the scale of
/// another element, or of the wave coordinates, cannot hide it.

#include <cstdint>
#include <string>
#include <vector>

#include "model/mode.hpp"

namespace pwlsim::engine {

/// Relative to a guard's rounding level (Mode::guard_noise, against ‖row‖‖y‖): the difference of two consecutive modes at one zero.
inline constexpr double rounding_levels = 30.0;  ///< Of: a guard's rounding level. Why: two modes differ by that at one zero.
inline constexpr double broken_share = 1e-2;  ///< Of: a quantity's largest value. Why: a violation beyond this and the next ends the run.
inline constexpr double broken_levels = 1e4;  ///< Of: a quantity's rounding level. Why: four digits beyond rounding, see `broken_share`.

class GuardWatch {
 public:
  explicit GuardWatch(const model::System& system);

  /// At time `time` the mode is at y.
  void look(const model::Mode& mode, const double* y, double time);

  /// The same inside a segment of this length from y0 at `begin`: for the first segments, and an even selection of later ones.
  void look_inside(const model::Mode& mode, const double* y0, double begin, double length);

  struct Violation {
    int port = -1;          ///< none: −1
    bool is_input = false;  ///< u (the mode has the port active), else y
    double value = 0.0;     ///< below zero, in the port's own unit
    double largest = 0.0;   ///< largest magnitude of this quantity
    double time = 0.0;
    [[nodiscard]] double share() const { return largest > 0.0 ? value / largest : 0.0; }
  };
  /// The one with the largest share.
  [[nodiscard]] Violation worst() const;
  /// Whether the last look found a violation beyond rounding: the present mode is not the solution.
  [[nodiscard]] bool is_broken() const { return is_broken_; }

 private:
  void find_violation(const model::Mode& mode, const double* y, int port, double value, double time);

  const model::System& system_;
  std::uint64_t segments_ = 0;
  std::vector<double> y_, work_;
  std::vector<double> values_, largest_, below_, time_;  ///< of guards; of y and u of each port
  bool is_broken_ = false;
};

/// "D1: -3.2 V, where its largest voltage is 640 V".
[[nodiscard]] std::string violation_text(const model::System& system, const GuardWatch::Violation& violation);

}  // namespace pwlsim::engine
