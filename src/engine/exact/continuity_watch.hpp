#pragma once
/// Checks charge and flux at every instant of a run: a capacitor's voltage and an inductor's current change only by impulses of the ports.
///
/// In energy coordinates ξ⁺ − ξ⁻ = B Λ, with Λ = ∫u dt of the ports over the instant (van der Schaft & Schumacher 1996, §3). The state before comes from the end of the
/// segment, the state after is that from which the next segment begins, so that all that lies between (projections, changes of coordinates,
/// several selections) is in the sum. Any remainder beyond rounding counts relative to the largest value of that coordinate in the run.

#include "model/selection.hpp"

namespace pwlsim::engine {

class ContinuityWatch {
 public:
  explicit ContinuityWatch(const model::System& system);

  /// Accuracy of instants, s: states may have moved for that time.
  void set_tolerance(double tolerance) { tolerance_ = tolerance; }
  /// An instant begins, with the state x = (ξ, ζ) before it.
  void begin(const double* x);
  /// A selection has jumped.
  void jumped(const model::Details& details);
  /// This instant is not checked: the impulse of its jump is not of first order.
  void excuse() { is_open_ = false; }
  /// Where a segment ends and the next one begins.
  struct Side {
    const model::Mode* mode = nullptr;  ///< null: none
    const double* y = nullptr;
  };
  void end(const Side& before, const Side& after, double time);

  struct Break {
    int coordinate = -1;  ///< of ξ; none: −1
    double share = 0.0;   ///< unexplained change, relative to the largest value
    double time = 0.0;
  };
  [[nodiscard]] Break worst() const;
  /// Whether a change beyond rounding was found.
  [[nodiscard]] bool is_broken() const { return is_broken_; }

 private:
  void examine(const Side& before, const Side& after, double time);
  [[nodiscard]] model::Vector rate(const Side& side) const;

  const model::System& system_;
  double tolerance_ = 0.0;
  bool is_open_ = false, is_broken_ = false, is_moved_ = false;
  std::vector<double> before_, x_;  ///< left and right of the instant
  model::Vector moved_;             ///< B Λ
  std::vector<double> largest_, unexplained_, time_;
};

}  // namespace pwlsim::engine
