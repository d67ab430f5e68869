#pragma once
/// The solution of a run for pictures and pages, in bounded memory: not its rows, but the polynomials between events.
///
/// While they are few, all pieces are kept, each signal as a Legendre series that is cut where the remainder is below rounding. Later the oldest pieces are reduced:
/// for each of many equal bins of time the exact least and largest value, mean and mean square of each signal are kept. So the end of a
/// long run is complete, and the time before it is kept as far as a picture shows it.

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "engine/run.hpp"
#include "linalg/legendre.hpp"

namespace pwlsim::measure {

class SolutionRecord {
 public:
  /// Of `signals` signals from `from` to `to`; `sharers`: how many records share the memory that one may take.
  SolutionRecord(double from, double to, std::size_t signals, std::size_t sharers = 1);

  /// Appends a piece. `values`: signal by signal, at the Gauss–Legendre points of [begin, begin + length].
  void take(const engine::Piece& piece);

  [[nodiscard]] std::size_t signals() const { return signals_; }
  [[nodiscard]] bool empty() const { return pieces_.empty() && bins_.empty(); }
  /// Whether bins replace the beginning of the run.
  [[nodiscard]] bool is_thinned() const { return !bins_.empty(); }

  struct Piece {
    double from = 0.0, to = 0.0;
    std::vector<std::uint8_t> lengths;  ///< of each signal's series
    std::vector<double> coefficients;   ///< of all signals, one after the other
  };
  [[nodiscard]] const std::deque<Piece>& pieces() const { return pieces_; }

  struct Share {
    double least = 0.0, largest = 0.0, mean = 0.0, square = 0.0;
  };
  struct Bin {
    double from = 0.0, to = 0.0;
    std::vector<Share> shares;  ///< of each signal
  };
  /// Ascending, without gaps, up to the first piece. At most `most`; neighbours are joined.
  [[nodiscard]] std::vector<Bin> bins(std::size_t most) const;
  /// The number of bins for a page of these signals.
  [[nodiscard]] std::size_t bins_of_page() const;

  /// A signal as a polyline that a picture of the whole run does not distinguish from the solution: it contains the extremes, and each bin is a line between its
  /// extremes. A jump is two points at one time.
  struct Line {
    std::vector<double> times, values;
  };
  [[nodiscard]] Line line(std::size_t signal) const;

 private:
  void drop_oldest();
  void add_to_bins(const Piece& piece);
  void add_to_bin(Bin& bin, double from, double to, const Piece& piece);
  void add_curve(Line& line, const Piece& piece, const linalg::LegendreSeries& series, std::size_t length) const;
  [[nodiscard]] Bin& bin_at(double time);
  [[nodiscard]] double largest_end(const Bin& bin) const;

  double from_, to_;
  std::size_t signals_, most_coefficients_;
  std::deque<Piece> pieces_;
  std::size_t coefficients_ = 0;
  std::vector<double> largest_;  ///< magnitude of each signal so far
  std::vector<Bin> bins_;
};

/// The series of a signal in a piece.
[[nodiscard]] linalg::LegendreSeries series_of(const SolutionRecord::Piece& piece, std::size_t signal);

}  // namespace pwlsim::measure
