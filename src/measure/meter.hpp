#pragma once
/// One measurement on its way through the run: pieces in, a value out.
///
/// Integrals are Gauss quadratures of pieces that are polynomials to rounding, summed in extended precision; extrema are zeros of derivatives, passages
/// zeros of differences. Nothing depends on the rows.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "measure/crossing_watch.hpp"

namespace pwlsim::measure {

/// Where a value was found, s: the window; the time of a crossing, or AT; that of the least and the largest value.
struct Place {
  double from = 0.0, to = 0.0, at = 0.0, least_at = 0.0, largest_at = 0.0;
  double piece_from = 0.0, piece_to = 0.0;  ///< what the piece stands for in which `at` lies
};

class Meter {
 public:
  /// `results` of other measurements must be known; `start`, `stop`: of the rows, `end`: how far it may reach, s. `failure()` tells where the window is none.
  Meter(const circuit::Measurement& measurement, const std::vector<double>& results, double start, double stop, double end);

  /// What it needs to see of the run, s.
  [[nodiscard]] double from() const { return needs_left_ ? std::max(0.0, from_ - lead_) : from_; }
  [[nodiscard]] double to() const { return to_; }
  [[nodiscard]] bool is_done() const { return !failure_.empty() || (watch_ && watch_->is_done()); }

  void before_start(PieceView& view);
  void take(PieceView& view);
  /// ∫ dt of each probe over an instant; the view holds what is before it, if it has been seen.
  void take_impulse(double time, std::span<const double> values, const PieceView& before);
  /// The run is over at `reached`.
  void finish(double reached);

  [[nodiscard]] double value() const { return value_; }
  /// Where the value was found.
  [[nodiscard]] Place place() const { return {from_, to_, found_at_, least_at_, largest_at_, found_in_from_, found_in_to_}; }
  /// Why there is no value; else "".
  [[nodiscard]] const std::string& failure() const { return failure_; }
  /// Impulses of what it reads lie in its window.
  [[nodiscard]] bool met_impulse() const { return met_impulse_; }
  /// The impulses in its window that the value holds nothing of, in words; "" where there are none.
  [[nodiscard]] std::string left_out() const;

 private:
  using Kind = circuit::Measurement::Kind;
  void set_window(double start, double stop, double end);
  void set_place(double stop);
  [[nodiscard]] bool is_finite(const Part& part);
  void fail(std::string text) { failure_ = std::move(text); }
  [[nodiscard]] bool integrates() const { return measurement_.kind == Kind::integral || measurement_.kind == Kind::average; }
  [[nodiscard]] bool feels(std::span<const double> impulses, double time) const;
  void leave_out(double time);
  void note_sizes(const engine::Piece& piece);
  void settle_impulses(const PieceView& after);
  void take_window(PieceView& view, double from, double to);
  void take_at(PieceView& view);
  void take_when(PieceView& view, double from, double to);
  void read_at(PieceView& view, double time);
  void add(const Part& part);
  void add_extremes(const Part& part);
  [[nodiscard]] double noise_of(PieceView& view, double from, double to);

  const circuit::Measurement& measurement_;
  const std::vector<double>& results_;
  Program expression_, difference_, left_, right_;
  std::optional<CrossingWatch> watch_;
  double from_ = 0.0, to_ = 0.0, at_ = 0.0;
  double sliver_ = 0.0;      ///< shorter is rounding of an instant, s
  double lead_ = 0.0;        ///< so much before its window, s
  bool needs_left_ = false;  ///< the factors of an impulse at the begin of its window
  bool found_ = false;
  double found_at_ = 0.0, found_in_from_ = 0.0, found_in_to_ = 0.0;
  double value_ = 0.0;
  std::string failure_;
  long double sum_ = 0.0L;
  double scale_ = 0.0;  ///< largest value so far
  bool any_ = false;
  /// Impulses that wait for what comes after them.
  struct Instant {
    double time = 0.0;
    std::vector<double> impulses, left;  ///< of each probe; `left` is empty where it was not seen
  };
  std::optional<Instant> instant_;
  std::vector<double> sizes_;  ///< of each probe the largest magnitude so far
  bool met_impulse_ = false;
  std::size_t left_out_ = 0;
  double first_left_out_ = 0.0, last_left_out_ = 0.0;
  double least_ = 0.0, least_at_ = 0.0, largest_ = 0.0, largest_at_ = 0.0;
};

}  // namespace pwlsim::measure
