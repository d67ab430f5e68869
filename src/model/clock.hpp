#pragma once
/// A switch that only piecewise-linear sources drive: the times at which it changes sides follow from the sources alone,
///
///     v(t) = constant + Σ gain_k · track_k(t),   on -> off where v falls below off_level, off -> on where v rises above on_level,
///
/// so that no state, no mode and no search for guards is needed. Where v touches its threshold, the slope decides; where v stays there, a switch
/// without hysteresis is off.

#include <functional>
#include <memory>
#include <vector>

#include "model/system.hpp"

namespace pwlsim::model {

class Clock {
 public:
  /// Time at which the sources are on a threshold and cross it, or jump.
  struct Instant {
    double time = forever;
    double late = 0.0;  ///< rounding error of the time
    bool flips = false;
    bool is_edge = false;  ///< a source jumps
  };

  /// gain · track(t).
  struct Term {
    std::shared_ptr<const Track> track;
    double gain;
    bool may_jump = false;
    Track::Cursor cursor{};
  };

  /// Whether the control reads only piecewise-linear sources: no state, no port, no derivative of these sources, and none
  /// that is held.
  [[nodiscard]] static bool can_drive(const System& system, const Control& control);

  /// A clock for such a control. Breakpoints closer than `tolerance` are one.
  Clock(const System& system, const Control& control, double tolerance);
  Clock(std::vector<Term> terms, double constant, double on_level, double off_level, int driven, double tolerance);

  /// From the left limit at `time`; a switch on the wrong side there flips at once.
  void start(bool is_on, double time = 0.0);
  [[nodiscard]] bool is_on() const { return is_on_; }
  /// The next instant to take: a flip, a jump of a source, or an empty one after very many corners without either.
  [[nodiscard]] const Instant& next() const { return next_; }
  /// Takes it and finds the next one.
  void take();
  /// The control between two corners.
  struct Line {
    double from = 0.0, to = 0.0;
    double first = 0.0, last = 0.0;  ///< its values there
    double noise = 0.0;              ///< rounding of the terms that they are sums of
    bool is_flat = false;
  };
  /// The control itself from t = 0 to `stop`, independent of the time of the clock: line by line, at most `most` of them.
  void trace(double stop, std::size_t most, const std::function<void(const Line&)>& see) const;
  /// Number of the switch in the whole model.
  [[nodiscard]] int driven() const { return driven_; }

 private:
  /// v − threshold or threshold − v, ≥ 0 while the switch stays, with its slope (0 where that is rounding) and the rounding of its terms.
  struct Margin {
    double value = 0.0, slope = 0.0, noise = 0.0;
    bool passes_at_rest = false;  ///< where both are rounding
    /// Sign of the first of value and slope that is not rounding.
    [[nodiscard]] bool departs() const { return value < -noise || (value <= noise && (slope < 0.0 || (slope == 0.0 && passes_at_rest))); }
  };

  /// The next instant from a place in the repeating period: the same in every period.
  struct Recurrence {
    bool is_known = false;
    int passed = 0;    ///< corners, before it
    double tau = 0.0;  ///< from the last of them to the instant
    bool flips = false, is_edge = false, crosses = false;
  };

  [[nodiscard]] Margin margin_at(double time, double late) const;
  [[nodiscard]] Recurrence* recurrence();
  void repeat(const Recurrence& known);
  void finish_cursor();
  void search();
  bool cross_before(double end, double end_late, const Margin& margin);
  bool pass(double time, double late);

  std::vector<Term> terms_;
  double constant_ = 0.0, on_level_ = 0.0, off_level_ = 0.0, tolerance_ = 0.0;
  int driven_ = 0;
  bool is_on_ = false;
  double from_ = 0.0, late_ = 0.0;       ///< searched up to here
  bool inside_ = false;                  ///< that is within a segment
  bool has_next_ = true;                 ///< a single track's cursor knows its `next`
  std::vector<Recurrence> recurrences_;  ///< of a single track: by segment, side of the switch, and whether within the segment
  Instant next_;
};

}  // namespace pwlsim::model
