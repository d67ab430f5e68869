#pragma once
/// Computes one measurement during the run: pieces in, a value out.
///
/// Integrals are Gauss quadratures of pieces that are polynomials to rounding, summed in extended precision; extrema are zeros of derivatives, crossings
/// zeros of differences. Nothing depends on the rows.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "measure/crossing_watch.hpp"

namespace pwlsim::measure {

/// Times of a value, s: the window; the time of a crossing, or AT; the times of the least and the largest value.
struct Place {
  double from = 0.0, to = 0.0, at = 0.0, least_at = 0.0, largest_at = 0.0;
  double piece_from = 0.0, piece_to = 0.0;  ///< the piece that contains `at`
};

class Meter {
 public:
  /// `results` of other measurements must be known; `start`, `stop`: of the rows, `end`: the latest end of a window, s. `failure()` reports an invalid window.
  Meter(const circuit::Measurement& measurement, const std::vector<double>& results, double start, double stop, double end);

  /// The interval of the run that it needs, s.
  [[nodiscard]] double from() const { return needs_left_ ? std::max(0.0, from_ - lead_) : from_; }
  [[nodiscard]] double to() const { return to_; }
  [[nodiscard]] bool is_done() const { return !failure_.empty() || (watch_ && watch_->is_done()); }

  void before_start(PieceView& view);
  void take(PieceView& view);
  /// ∫ dt of each probe over an instant; the view holds the piece before it, if there is one.
  void take_impulse(double time, std::span<const double> values, const PieceView& before);
  /// The run ended at `reached`.
  void finish(double reached);

  [[nodiscard]] double value() const { return value_; }
  /// The times of the value.
  [[nodiscard]] Place place() const { return {from_, to_, found_at_, least_at_, largest_at_, found_in_from_, found_in_to_}; }
  /// Why there is no value; "" if there is one.
  [[nodiscard]] const std::string& failure() const { return failure_; }
  /// Whether its window contains impulses of signals that it reads.
  [[nodiscard]] bool met_impulse() const { return met_impulse_; }
  /// The impulses in its window that the value excludes, as text; "" if there are none.
  [[nodiscard]] std::string left_out() const;

 private:
  using Kind = circuit::Measurement::Kind;
  void set_window(double start, double stop, double end);
  void set_place(double stop);
  [[nodiscard]] bool is_finite(const PolynomialPart& part);
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
  void add(const PolynomialPart& part);
  void add_extremes(const PolynomialPart& part);
  [[nodiscard]] double noise_of(PieceView& view, double from, double to);

  const circuit::Measurement& measurement_;
  const std::vector<double>& results_;
  Program expression_, difference_, left_, right_;
  std::optional<CrossingWatch> watch_;
  double from_ = 0.0, to_ = 0.0, at_ = 0.0;
  double sliver_ = 0.0;      ///< a shorter interval is rounding of an instant, s
  double lead_ = 0.0;        ///< needed time before its window, s
  bool needs_left_ = false;  ///< for the factors of an impulse at the start of its window
  bool found_ = false;
  double found_at_ = 0.0, found_in_from_ = 0.0, found_in_to_ = 0.0;
  double value_ = 0.0;
  std::string failure_;
  long double sum_ = 0.0L;
  double scale_ = 0.0;  ///< largest value so far
  bool any_ = false, only_slivers_ = false;
  /// Impulses that wait for the piece after them.
  struct Instant {
    double time = 0.0;
    std::vector<double> impulses, left;  ///< of each probe; `left` is empty if the piece before was not seen
  };
  std::optional<Instant> instant_;
  std::vector<double> sizes_;  ///< the largest magnitude of each probe so far
  bool met_impulse_ = false;
  std::size_t left_out_ = 0;
  double first_left_out_ = 0.0, last_left_out_ = 0.0;
  double least_ = 0.0, least_at_ = 0.0, largest_ = 0.0, largest_at_ = 0.0;
};

}  // namespace pwlsim::measure
