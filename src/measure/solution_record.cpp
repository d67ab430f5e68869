#include "measure/solution_record.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pwlsim::measure {
namespace {

/// Of all records that share: as many as a page of some three megabytes holds as text.
constexpr std::size_t most_coefficients = 150'000;
constexpr std::size_t least_pieces = 16;  ///< kept in any case
/// Of a record; a picture has half as many columns. On a page signals share room for so many.
constexpr std::size_t most_bins = 2000, bins_times_signals = 30'000, least_bins = 100;
/// Of a signal's largest value: a series is cut where the rest is smaller. Statistics keep twelve digits.
constexpr double cut = 1e-13;
/// Points a piece has for each of so many parts of the run; it bends too little between them to be seen.
constexpr double columns = 3200.0;
constexpr double most_points = 4000.0;

}  // namespace

linalg::LegendreSeries series_of(const SolutionRecord::Piece& piece, std::size_t signal) {
  const auto first = std::accumulate(piece.lengths.begin(), piece.lengths.begin() + static_cast<std::ptrdiff_t>(signal), std::size_t{0});
  return linalg::LegendreSeries(std::span(piece.coefficients).subspan(first, piece.lengths[signal]));
}

SolutionRecord::SolutionRecord(double from, double to, std::size_t signals, std::size_t sharers)
    : from_(from),
      to_(to),
      signals_(signals),
      most_coefficients_(most_coefficients / std::max<std::size_t>(sharers, 1)),
      largest_(signals, 0.0) {}

void SolutionRecord::take(const engine::Piece& piece) {
  constexpr std::size_t points = linalg::legendre_points;
  Piece kept{piece.from, piece.to, {}, {}};
  const double lower = piece.place(piece.from), upper = piece.place(piece.to);
  const bool is_whole = piece.from == piece.begin && piece.to == piece.begin + piece.length;
  for (std::size_t k = 0; k < signals_; ++k) {
    const double* values = &piece.values[k * points];
    const linalg::LegendreSeries whole(values);
    const linalg::LegendreSeries series = is_whole ? whole : whole.on(lower, upper);
    for (std::size_t i = 0; i < points; ++i) largest_[k] = std::max(largest_[k], std::abs(values[i]));
    const auto& c = series.coefficients();
    std::size_t length = points;
    double rest = 0.0;
    while (length > 1 && (rest += std::abs(c[length - 1])) <= cut * largest_[k]) --length;
    kept.lengths.push_back(static_cast<std::uint8_t>(length));
    kept.coefficients.insert(kept.coefficients.end(), c.begin(), c.begin() + static_cast<std::ptrdiff_t>(length));
  }
  coefficients_ += kept.coefficients.size();
  pieces_.push_back(std::move(kept));
  while (coefficients_ > most_coefficients_ && pieces_.size() > least_pieces) drop_oldest();
}

void SolutionRecord::drop_oldest() {
  const Piece& oldest = pieces_.front();
  coefficients_ -= oldest.coefficients.size();
  add_to_bins(oldest);
  pieces_.pop_front();
}

/// The next place of the grid, at which a bin ends at the latest.
double SolutionRecord::largest_end(const Bin& bin) const {
  const double length = (to_ - from_) / static_cast<double>(most_bins);
  return from_ + length * (std::floor((bin.from - from_) / length) + 1.0);
}

/// Where a piece from `time` on goes.
SolutionRecord::Bin& SolutionRecord::bin_at(double time) {
  if (bins_.empty() || time >= largest_end(bins_.back())) bins_.push_back({time, time, std::vector<Share>(signals_)});
  return bins_.back();
}

void SolutionRecord::add_to_bins(const Piece& piece) {
  for (double at = piece.from; at < piece.to;) {
    Bin& bin = bin_at(at);
    const double end = largest_end(bin);
    const double next = end > at ? std::min(piece.to, end) : piece.to;
    add_to_bin(bin, at, next, piece);
    at = next;
  }
}

void SolutionRecord::add_to_bin(Bin& bin, double from, double to, const Piece& piece) {
  const bool is_first = bin.to == bin.from;
  const double before = bin.to - bin.from, now = to - from, share = now / (before + now);
  const double span = piece.to - piece.from;
  for (std::size_t k = 0; k < signals_; ++k) {
    linalg::LegendreSeries series = series_of(piece, k);
    if (from != piece.from || to != piece.to)
      series = series.on(2.0 * (from - piece.from) / span - 1.0, 2.0 * (to - piece.from) / span - 1.0);
    const auto& c = series.coefficients();
    double square = 0.0;  // Parseval
    for (std::size_t j = 0; j < c.size(); ++j) square += c[j] * c[j] / (2.0 * static_cast<double>(j) + 1.0);
    Share& s = bin.shares[k];
    s.mean += share * (c[0] - s.mean);
    s.square += share * (square - s.square);
    if (!is_first && c[0] - series.variation() >= s.least && c[0] + series.variation() <= s.largest) continue;
    const linalg::Extremes extremes = linalg::extremes(series);
    s.least = is_first ? extremes.least : std::min(s.least, extremes.least);
    s.largest = is_first ? extremes.largest : std::max(s.largest, extremes.largest);
  }
  bin.to = to;
}

std::size_t SolutionRecord::bins_of_page() const { return std::max(least_bins, bins_times_signals / std::max<std::size_t>(signals_, 1)); }

std::vector<SolutionRecord::Bin> SolutionRecord::bins(std::size_t most) const {
  const std::size_t joined = (bins_.size() + most - 1) / most;
  std::vector<Bin> result;
  for (std::size_t k = 0; k < bins_.size(); ++k) {
    const Bin& bin = bins_[k];
    if (k % joined == 0) {
      result.push_back(bin);
      continue;
    }
    Bin& last = result.back();
    const double share = (bin.to - bin.from) / (bin.to - last.from);
    for (std::size_t i = 0; i < signals_; ++i) {
      Share& s = last.shares[i];
      const Share& next = bin.shares[i];
      s = {std::min(s.least, next.least), std::max(s.largest, next.largest), std::lerp(s.mean, next.mean, share),
           std::lerp(s.square, next.square, share)};
    }
    last.to = bin.to;
  }
  return result;
}

SolutionRecord::Line SolutionRecord::line(std::size_t signal) const {
  Line line;
  const auto add = [&](double time, double value) {
    line.times.push_back(time);
    line.values.push_back(value);
  };
  for (const Bin& bin : bins_) {
    add(bin.from, bin.shares[signal].least);
    add(bin.to, bin.shares[signal].largest);
  }
  for (const Piece& piece : pieces_) add_curve(line, piece, series_of(piece, signal), piece.lengths[signal]);
  return line;
}

void SolutionRecord::add_curve(Line& line, const Piece& piece, const linalg::LegendreSeries& series, std::size_t length) const {
  constexpr std::size_t straight = 2;  // a line has two coefficients
  const double span = piece.to - piece.from;
  std::vector<double> places{-1.0, 1.0};
  if (length > straight) {
    const double parts = std::min(most_points, std::ceil(columns * span / (to_ - from_)));
    for (double k = 1.0; k < parts; ++k) places.push_back(2.0 * k / parts - 1.0);
    const linalg::Extremes extremes = linalg::extremes(series);
    places.insert(places.end(), {extremes.least_at, extremes.largest_at});
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
  }
  for (const double x : places) {
    const double time = x == 1.0 ? piece.to : piece.from + 0.5 * (x + 1.0) * span;
    const double value = series(x);
    if (!line.times.empty() && line.times.back() == time && line.values.back() == value) continue;
    line.times.push_back(time);
    line.values.push_back(value);
  }
}

}  // namespace pwlsim::measure
