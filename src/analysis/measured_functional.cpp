#include "analysis/measured_functional.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pwlsim::analysis {

namespace {

constexpr double same_shift = 1e-9;  ///< of two shifts: they are one
constexpr double same_side = 1e-7;   ///< of the derivatives to both sides: they are one
constexpr double tie_noise = 1e-9;   ///< of values that tie: what derivatives by all of a parameter hold of their being not quite equal

}  // namespace

MeasuredSum shift_of(std::size_t instant) {
  MeasuredSum sum;
  sum.run.shifts[instant] = 1.0;
  return sum;
}

void MeasuredSum::add(double weight, const MeasuredSum& other) {
  if (weight == 0.0) return;
  run.add(weight, other.run);
  start_moves += weight * other.start_moves;
  stop_moves += weight * other.stop_moves;
  if (numbers.size() < other.numbers.size()) numbers.resize(other.numbers.size(), 0.0);
  for (std::size_t k = 0; k < other.numbers.size(); ++k) numbers[k] += weight * other.numbers[k];
}

bool MeasuredSum::is_empty() const {
  return run.is_empty() && start_moves == 0.0 && stop_moves == 0.0 &&
         std::all_of(numbers.begin(), numbers.end(), [](double n) { return n == 0.0; });
}

void MeasuredFunctional::add(double weight, const MeasuredFunctional& other) {
  sum.add(weight, other.sum);
  for (const Kink& kink : other.kinks) kinks.push_back({kink.q, weight * kink.weight, kink.sign, kink.why});
  obstacles.insert(obstacles.end(), other.obstacles.begin(), other.obstacles.end());
  for (const Tie& tie : other.ties) {
    ties.push_back(tie);
    ties.back().weight *= weight;
  }
  if (failure.empty()) failure = other.failure;
}

double read_direct(const MeasuredSum& sum, const DirectMoves& direct) {
  double value = sum.start_moves * direct.start_moves + sum.stop_moves * direct.stop_moves;
  if (direct.number >= 0 && static_cast<std::size_t>(direct.number) < sum.numbers.size())
    value += sum.numbers[static_cast<std::size_t>(direct.number)];
  return value;
}

double ForwardReader::read(const MeasuredSum& sum) { return read(sum.run) + read_direct(sum, direct_); }

double ForwardReader::read(const steady::Functional& functional) {
  const std::vector<int>& signals = run_.measurements->probe_signals;
  long double sum = 0.0L;
  for (const steady::Functional::Stretch& stretch : functional.stretches)
    sum += sensitivity_.moved_over(followed_, parameter_, signals, stretch);
  for (const auto& [instant, weight] : functional.shifts) sum += weight * followed_.shifts[instant];
  for (const steady::Functional::Point& point : functional.points) {
    const std::vector<steady::MovedJet> jets = sensitivity_.moved_signals_at(followed_, parameter_, signals, point.time, point.side);
    for (std::size_t k = 0; k < point.moved.size(); ++k) sum += point.moved[k] * jets[k].moved;
    for (std::size_t k = 0; k < point.rates.size(); ++k) sum += point.rates[k] * jets[k].moved_rate;
  }
  for (const auto& [number, interval] : functional.intervals) {
    auto& points = points_[number];
    if (points.empty()) points = sensitivity_.moved_at(followed_, parameter_, signals, interval.inside, interval.begin, interval.length);
    const std::size_t width = signals.size();
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t k = 0; k < width; ++k) sum += interval.weights[i * width + k] * points[i][k];
  }
  return static_cast<double>(sum);
}

namespace {

/// The largest of equal values grows as fast as the fastest of them, and falls as slowly as the slowest.
TwoSided of_tie(const MeasuredFunctional::Tie& tie, const std::function<double(const MeasuredSum&)>& read) {
  TwoSided taken;
  for (const MeasuredFunctional& place : tie.places) {
    const TwoSided own = two_sided(place, read);
    if (!own.failure.empty()) return own;
    const bool is_first = &place == &tie.places.front();
    taken.right = is_first ? own.right : tie.is_largest ? std::max(taken.right, own.right) : std::min(taken.right, own.right);
    taken.left = is_first ? own.left : tie.is_largest ? std::min(taken.left, own.left) : std::max(taken.left, own.left);
    taken.noise = std::max(taken.noise, own.noise);
    if (is_first) taken.measured = own.right;
  }
  taken.noise = std::max(taken.noise, tie_noise * tie.size);
  taken.kink = tie.why;
  return taken;
}

}  // namespace

std::size_t MeasuredFunctional::sums() const {
  std::size_t count = 1 + kinks.size() + obstacles.size();
  for (const Tie& tie : ties)
    for (const MeasuredFunctional& place : tie.places) count += place.sums();
  return count;
}

TwoSided two_sided(const MeasuredFunctional& functional, const std::function<double(const MeasuredSum&)>& read) {
  if (!functional.failure.empty()) return TwoSided::failed(functional.failure);
  for (const MeasuredFunctional::Obstacle& obstacle : functional.obstacles) {
    const double moves = read(obstacle.moves), against = obstacle.against.is_empty() ? 0.0 : read(obstacle.against);
    if (std::abs(moves - against) > same_shift * (std::abs(moves) + std::abs(against))) return TwoSided::failed(obstacle.why);
  }
  double left = read(functional.sum), right = left;
  TwoSided result;
  result.measured = left;
  for (const MeasuredFunctional::Kink& kink : functional.kinks) {
    const double q = read(kink.q);
    (q * kink.sign > 0.0 ? right : left) += kink.weight * q;
    if (q != 0.0 && result.kink.empty()) result.kink = kink.why;
  }
  for (const MeasuredFunctional::Tie& tie : functional.ties) {
    const TwoSided taken = of_tie(tie, read);
    if (!taken.failure.empty()) return taken;
    left += tie.weight * taken.left;
    right += tie.weight * taken.right;
    result.noise = std::max(result.noise, taken.noise * std::abs(tie.weight));
    result.measured += tie.weight * taken.measured;
    if (result.kink.empty()) result.kink = taken.kink;
  }
  if (!(std::isfinite(left) && std::isfinite(right))) return TwoSided::failed("the derivative is not a finite number");
  const bool is_one = std::abs(left - right) <= same_side * (std::abs(left) + std::abs(right));
  result.right = right;
  result.left = is_one ? right : left;
  if (is_one) result.kink.clear();
  return result;
}

}  // namespace pwlsim::analysis
