#include "analysis/extreme_finder.hpp"

#include <algorithm>
#include <cmath>

#include "linalg/legendre.hpp"

namespace pwlsim::analysis {
namespace {

using circuit::Measurement;
using Kind = Measurement::Kind;

/// Values that differ by less, of the largest magnitude, tie.
constexpr double equal_values = 1e-11;

bool is_of_largest(Kind kind) { return kind == Kind::maximum || kind == Kind::time_of_maximum || kind == Kind::peak_to_peak; }

}  // namespace

bool is_extreme(Kind kind) { return is_of_largest(kind) || kind == Kind::minimum || kind == Kind::time_of_minimum; }

ExtremeFinder::ExtremeFinder(const Measurement& measurement, const measure::Place& place)
    : program_(measurement.expression), from_(place.from), to_(place.to) {}

void ExtremeFinder::take(measure::PieceView& view, const std::vector<double>& results) {
  const double from = std::max(view.piece().from, from_), to = std::min(view.piece().to, to_);
  if (from < to) (void)view.resolve(program_, results, from, to, size_, [&](const measure::PolynomialPart& part) { take(part); });
}

void ExtremeFinder::take(const measure::PolynomialPart& part) {
  for (const double value : part.values) size_ = std::max(size_, std::abs(value));
  const double mean = part.series.mean(), reach = part.series.variation(), near = equal_values * size_;
  const auto may_hold = [&](const Best& best) { return best.places.empty() || best.sign * mean + reach >= best.best - near; };
  if (!may_hold(least_) && !may_hold(largest_)) return;
  const linalg::Extremes found = linalg::extremes(part.series);
  const bool is_flat = found.largest - found.least <= near;
  for (Best* best : {&least_, &largest_}) {
    const bool is_least = best == &least_;
    if (!is_flat) add(*best, part.time(is_least ? found.least_at : found.largest_at), is_least ? found.least : found.largest);
    // What is level here need not be so for other values of a parameter.
    if (!is_flat) continue;
    add(*best, part.from, part.series(-1.0));
    add(*best, part.to, part.series(1.0));
  }
}

void ExtremeFinder::add(Best& best, double time, double value) const {
  const double near = equal_values * size_;
  value *= best.sign;
  if (!best.places.empty() && value < best.best - near) return;
  if (best.places.empty() || value > best.best) best.best = value;
  if (!best.places.empty() && std::abs(best.places.back().first - time) <= same_place * (to_ + time)) {
    best.places.back().second = std::max(best.places.back().second, value);
    return;
  }
  best.places.emplace_back(time, value);
  if (best.places.front().second < best.best - near)
    std::erase_if(best.places, [&](const auto& each) { return each.second < best.best - near; });
}

ExtremePlaces ExtremeFinder::found() const {
  ExtremePlaces found;
  found.size = size_;
  for (const Best* best : {&least_, &largest_})
    for (const auto& [time, value] : best->places)
      if (value >= best->best - equal_values * size_) (best == &least_ ? found.least : found.largest).push_back(time);
  return found;
}

}  // namespace pwlsim::analysis
