#pragma once
/// Sources as an autonomous linear system: between breakpoints  ζ' = A_w ζ,  w = C_w ζ  (van der Schaft & Schumacher 1996
/// take the input as given; putting it into the state makes every solution a matrix exponential).
///
/// Blocks of ζ: the constant 1; sin/cos pairs (shared by all undelayed sources of one frequency); levels (piecewise constant);
/// ramps (value and slope, the slope divided by its largest magnitude); decays e^{−t/τ}; small inputs with their derivatives, all of them zero.
/// A breakpoint sets its block anew.

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "linalg/dense.hpp"
#include "model/source_function.hpp"

namespace pwlsim::model {

/// A piecewise linear function of time as a list of segments, then a list that repeats.
class Track {
 public:
  struct Segment {
    double start = 0.0;  ///< prefix: absolute time; loop: offset in the period
    double value = 0.0;  ///< at the start
    double slope = 0.0;
  };
  double initial = 0.0;  ///< before the first segment
  std::vector<Segment> prefix;
  std::vector<Segment> loop;
  double loop_start = 0.0, loop_period = forever, loop_count = 0.0;
  double after_loop = 0.0;  ///< value after the last repetition

  [[nodiscard]] double largest_slope() const;
  /// Of the values at its corners.
  [[nodiscard]] double largest_value() const;
  /// Every segment begins where the one before it ends.
  [[nodiscard]] bool is_continuous() const;

  /// A place on the track: the segment in force and the time of the next one.
  struct Cursor {
    double start = 0.0, value = 0.0, slope = 0.0;
    double next = forever;
    double start_late = 0.0, next_late = 0.0;  ///< rounding errors of `start` and `next`
    double period_index = 0.0;
    std::size_t item = 0;  ///< of the next segment; counts through prefix, then loop
    /// A ramp meets the segment behind it up to the rounding of its value and of the times it runs between.
    [[nodiscard]] double rounding_at(double time) const;
    [[nodiscard]] double at(double time) const { return slope == 0.0 ? value : value + slope * (time - start); }
    /// At `time` + `late`, with `late` the rounding error of the time, from the segment's exact start.
    [[nodiscard]] double at(double time, double late) const {
      return slope == 0.0 ? value : value + slope * ((time - start) + (late - start_late));
    }
    /// Magnitudes of the terms that `at` is a sum of.
    [[nodiscard]] double size_at(double time) const { return std::abs(value) + std::abs(slope * (time - start)); }
  };
  /// Left limit at `time`: breakpoints at `time` itself are still to come.
  [[nodiscard]] Cursor before(double time) const;
  void advance(Cursor& cursor) const;
  /// Takes every breakpoint up to time + tolerance, one at least; true if the value jumped there.
  bool pass(Cursor& cursor, double time, double tolerance) const;
  /// Takes this many corners (one at least), all within the repetitions, and leaves `next` to `set_next`.
  void pass_in_loop(Cursor& cursor, int corners) const;
  void set_next(Cursor& cursor) const;

 private:
  void begin_segment(Cursor& cursor) const;
  void count_segment(Cursor& cursor) const;
};

[[nodiscard]] Track make_track(const Pulse& pulse);
[[nodiscard]] Track make_track(const Pwl& pwl);

/// A sum of sources this close to a level, against the terms it is made of, is on it; then its derivatives decide, each against its own terms.
constexpr double threshold_noise = 3e-14;  ///< Of: the terms of the sum. Why: 135 units of rounding of double.

class Exosystem {
 public:
  struct Block {
    enum class Kind { constant, oscillation, level, ramp, decay, small_input };
    Kind kind = Kind::constant;
    int first = 0;       ///< index of its first state
    int source = -1;     ///< −1 where sources share it
    double rate = 0.0;   ///< |eigenvalue|; for a ramp the slope that slope state 1 stands for
    double scale = 1.0;  ///< of a level or a ramp, the largest magnitude that its value has by itself; others are of order one
    double frequency = 0.0, omega = 0.0, damping = 0.0, phase = 0.0;
    double delay = 0.0, end = forever;  ///< oscillation, decay: alive in [delay, end)
    int partner = -1;                   ///< oscillation: its level state, −1: none
    int derivatives = 0;                ///< of a small input, beside its value
    /// Whether it has a rate of its own: not a constant, level or ramp.
    [[nodiscard]] bool is_curved() const { return kind == Kind::oscillation || kind == Kind::decay; }
    [[nodiscard]] int size() const {
      if (kind == Kind::small_input) return 1 + derivatives;
      return kind == Kind::oscillation || kind == Kind::ramp ? 2 : 1;
    }
    /// Bound of |ζ_block^{(order)}(t + s)|₂ for 0 ≤ s ≤ h from the block's state now; for a ramp only its value counts.
    [[nodiscard]] double derivative_bound(const double* zeta, int order, double h) const;
  };

  /// `functions[i]` becomes source i. The constant state is present when `needs_constant` or a source has a constant part.
  Exosystem(const std::vector<SourceFunction>& functions, bool needs_constant);

  [[nodiscard]] int size() const { return static_cast<int>(a_.rows()); }
  [[nodiscard]] const linalg::Matrix& a() const { return a_; }
  [[nodiscard]] int constant() const { return constant_; }  ///< index of the state 1, −1: none
  [[nodiscard]] const std::vector<Block>& blocks() const { return blocks_; }
  /// Largest rate of a block that is curved in time; 0 where none is.
  [[nodiscard]] double fastest() const;
  /// w_source = row · ζ.
  [[nodiscard]] const linalg::Matrix& rows() const { return rows_; }
  /// w = C_w ζ, without the zeros of C_w: of many sources each reads few states.
  [[nodiscard]] linalg::Vector values(const linalg::Vector& zeta) const;
  /// The same into an array of all sources.
  void values(const double* zeta, double* w) const;
  /// ζ' = A_w ζ, block by block.
  [[nodiscard]] linalg::Vector rates(const linalg::Vector& zeta) const;

  struct TrackBlock {
    Track track;
    int block;
    bool may_jump;     ///< false where a decay makes up for the track's jump
    int channel = -1;  ///< of a held source: its track is a constant that `hold` changes; −1: none
  };
  [[nodiscard]] const std::vector<TrackBlock>& tracks() const { return tracks_; }
  /// The same where held sources begin with these values, by channel.
  [[nodiscard]] Exosystem with_held(std::span<const double> values) const;

  /// The place of every piecewise source.
  struct Phase {
    std::vector<Track::Cursor> cursors;           ///< one a track
    std::vector<std::pair<double, int>> pending;  ///< (time, block) of starts and ends of oscillations and decays to come, ascending
    std::vector<signed char> stage;               ///< a block: 0 not started, 1 alive, 2 ended
    std::vector<double> held;                     ///< one per track: the value of a held source from its cursor's `next` on
    double next = forever;                        ///< time of the next breakpoint
  };
  /// Left limit at `time`.
  [[nodiscard]] Phase start(double time = 0.0) const;
  /// Takes every breakpoint up to time + tolerance; true if some source value jumped there.
  bool advance(Phase& phase, double time, double tolerance) const;
  /// The held sources of this channel change to `value` at `time`, which is a breakpoint then where it is another value.
  void hold(Phase& phase, int channel, double value, double time) const;
  /// ζ at `time` within the segments of the phase.
  void evaluate(const Phase& phase, double time, double* zeta) const;
  /// The same for oscillations and decays alone, at time + late, with `late` the rounding error of the time.
  void evaluate_curved(const Phase& phase, double time, double late, double* zeta) const;
  /// Magnitudes of the terms that these ζ are sums of.
  void sizes(const Phase& phase, double time, const double* zeta, double* size) const;
  /// Oscillations or decays: not all sources are piecewise linear.
  [[nodiscard]] bool has_curved() const { return curved_; }

 private:
  int add_block(Block block);
  int find_oscillation(double omega) const;
  void add(int source, const Dc& f);
  void add(int source, const Sin& f);
  void add(int source, const Pulse& f);
  void add(int source, const Pwl& f);
  void add(int source, const Exp& f);
  void add(int source, const Held& f);
  void add(int source, const SmallInput& f);
  void add_track(int source, Track track, bool may_jump);
  void use_constant(int source, double value);
  void fill_matrices(int sources);
  void refresh_next(Phase& phase) const;

  struct Term {
    int source, state;
    double value;
  };
  linalg::Matrix a_, rows_;
  std::vector<Term> terms_;  ///< entries of `rows_` that are not zero, by states
  bool curved_ = false;
  std::vector<Block> blocks_;
  std::vector<TrackBlock> tracks_;
  std::vector<Term> coefficients_;  ///< in the order of sources; several may add up to one entry
  int states_ = 0;
  int constant_ = -1;
};

}  // namespace pwlsim::model
