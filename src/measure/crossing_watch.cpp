#include "measure/crossing_watch.hpp"

#include <cmath>

namespace pwlsim::measure {

void CrossingWatch::start(double value, double noise) {
  side_ = std::abs(value) <= noise ? Side::at_start : value < 0.0 ? Side::below : Side::above;
}

void CrossingWatch::take(const PolynomialPart& part, double noise, const std::function<void(double)>& passed) {
  const double mean = part.series.mean();
  const double variation = part.series.variation();
  if (std::abs(mean) + variation <= noise) return side(0, part.from, passed);
  if (std::abs(mean) > variation + noise) return side(mean < 0.0 ? -1 : 1, part.from, passed);
  double begin = -1.0;
  const auto stretch = [&](double end) {
    const double middle = part.series(0.5 * (begin + end));
    if (std::abs(middle) > noise) side(middle < 0.0 ? -1 : 1, part.time(begin), passed);
    begin = end;
  };
  for (const double zero : linalg::sign_changes(part.series, noise)) stretch(zero);
  stretch(1.0);
}

void CrossingWatch::finish(double value, double noise, double time, const std::function<void(double)>& passed) {
  if (std::abs(value) <= noise) side(0, time, passed);
}

/// From `time` on the expression has this sign.
void CrossingWatch::side(int sign, double time, const std::function<void(double)>& passed) {
  const Side before = side_;
  if (sign == 0) {
    if (before == Side::unknown) side_ = Side::at_start;
    if (before == Side::below || before == Side::above) {
      side_ = before == Side::below ? Side::at_from_below : Side::at_from_above;
      pass(before == Side::below, time, passed);
    }
    return;
  }
  side_ = sign < 0 ? Side::below : Side::above;
  const bool rises = sign > 0 && (before == Side::below || before == Side::at_from_above);
  const bool falls = sign < 0 && (before == Side::above || before == Side::at_from_below);
  if (rises || falls) pass(rises, time, passed);
}

void CrossingWatch::pass(bool rises, double time, const std::function<void(double)>& passed) {
  if (edge_ != circuit::Edge::any && (edge_ == circuit::Edge::rise) != rises) return;
  ++seen_;
  if (last_ || seen_ == count_) passed(time);
}

}  // namespace pwlsim::measure
