#pragma once
/// Polynomials of the probed signals between events.
///
/// Within a segment a signal is c·e^{Aτ}y. On intervals of length 2^p its values at the sixteen Gauss–Legendre points are rows c·e^{Aτ_i}, kept for each
/// mode and p, times the state at the interval's begin. An interval is accepted when the last coefficients of every signal are rounding and the
/// polynomial has the signal's value and its first three derivatives at the start; else it is halved. The derivatives detect a transient that ends before the
/// first point: a stiff segment costs some intervals for each octave between its fastest rate and its length. The last interval may extend
/// beyond the segment's end, where the mode's motion continues undisturbed.

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <unordered_map>
#include <vector>

#include "engine/exact/exact_model.hpp"
#include "engine/exact/recorder.hpp"
#include "engine/run.hpp"
#include "linalg/legendre.hpp"

namespace pwlsim::engine {

class PieceMaker : public Recorder {
 public:
  /// `interrupt` (may be null): if nonzero, no more pieces are passed on.
  PieceMaker(const std::vector<IslandRun>& runs, const std::vector<IslandModel>& islands, const Probes& probes,
             const std::atomic<int>* interrupt);

  /// To the sink: the signals at the operating point; nothing if the run starts elsewhere.
  void run_begins(const std::vector<std::vector<double>>& signals);
  void opens(const IslandAt& island, double /*length*/) { run_ended(island.time); }
  /// Passes on the pieces before `time`, up to which no island has opened since the last call.
  void run_ended(double time) {
    if (probes_.sink != nullptr && !cut_ && time > done_) pass_on(time);
  }
  /// Whether it was interrupted before all pieces were passed on, and at which time.
  [[nodiscard]] bool is_cut() const { return cut_; }
  [[nodiscard]] double cut_at() const { return cut_at_; }

 private:
  static constexpr int derivatives = 4;  ///< orders compared at an interval's begin, from 0

  /// The interval of length 2^level in one mode.
  struct Interval {
    linalg::Matrix points;  ///< shares·16 × ny
    /// shares × ny: the largest magnitudes of a share's rows, here and in shorter intervals: rounding of y excites fast modes again.
    linalg::Matrix bound;
    linalg::Matrix advance;  ///< e^{A 2^level} − 1
  };
  struct ModeRows {
    linalg::Matrix derivative;  ///< shares·derivatives × ny: c A^m
    linalg::Matrix bound;       ///< |c||A|^m
    linalg::Exponential transposed;
    std::map<int, Interval> intervals;
    int first_level = 0;  ///< of the first interval that was accepted last in a segment
    bool has_first = false;
  };
  /// An island that contributes to some probe.
  struct Track {
    std::size_t island = 0;
    std::vector<std::pair<std::size_t, std::size_t>> shares;  ///< output of the island, probe
    std::unordered_map<const model::Mode*, std::unique_ptr<ModeRows>> modes;
    const model::Mode* mode = nullptr;
    ModeRows* rows = nullptr;
    const Interval* interval = nullptr;  ///< tried last
    std::uint64_t segment = 0;
    double time = 0.0;  ///< of y
    std::vector<double> y, work;
    bool is_fresh = false;  ///< nothing of the segment has been passed on
  };

  void pass_on(double time);
  void follow(Track& track, const IslandRun& run, double time);
  [[nodiscard]] std::unique_ptr<ModeRows> rows_of(const Track& track, const model::Mode& mode) const;
  const Interval& interval_of(Track& track, int level);
  [[nodiscard]] int first_level(double longest) const;
  [[nodiscard]] int always_resolved() const;
  void fill(int level);
  [[nodiscard]] bool resolved(double length) const;
  void hand_over_piece(double from, double to, int level);
  void step(double end, int level);
  static void advance(Track& track, const linalg::Matrix& m, double factor);

  const std::vector<IslandRun>& runs_;
  const Probes& probes_;
  const std::atomic<int>* interrupt_;
  std::vector<Track> tracks_;
  double done_ = 0.0;
  int level_ = 0;  ///< of the interval before
  bool cut_ = false;
  double cut_at_ = 0.0;
  bool resumes_ = false;     ///< level_ belongs to this interval
  std::uint64_t short_ = 0;  ///< intervals of the segment that are short against the window
  std::vector<double> values_, starts_, bounds_, scratch_;
  std::vector<double> terms_;    ///< Σ |row||y| of a value at any point of the interval: what its rounding is a part of
  std::vector<double> largest_;  ///< of each probe so far
};

}  // namespace pwlsim::engine
