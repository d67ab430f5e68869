/// Functions of time alone: sums of constants, exponentials, sinusoids and one straight line, closed under products where that is possible.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "elements/formula.hpp"

namespace pwlsim::elements {
namespace {

using Kind = FormulaPart::Kind;

constexpr double half_turn = std::numbers::pi;
/// `time` itself is a PWL source that rises to here: later than any run.
constexpr double far_future = 1e15;
/// So near to a whole number a line begins at it.
constexpr double whole_number = 1e-12;

const model::Sin* oscillation_of(const FormulaPart& part) {
  return part.kind == Kind::time ? std::get_if<model::Sin>(&part.function) : nullptr;
}

model::Pwl time_itself() { return {{{0.0, 0.0}, {far_future, far_future}}, 0.0, 0.0}; }

bool is_time_itself(const FormulaPart& part) { return part.kind == Kind::time && part.function == model::SourceFunction(time_itself()); }

/// The point of the line through a and b at time t.
TablePoint at(const TablePoint& a, const TablePoint& b, double t) { return {t, a.y + (b.y - a.y) / (b.x - a.x) * (t - a.x)}; }

}  // namespace

AffineSum FormulaBuilder::function_of_time(model::SourceFunction function) {
  return part({.kind = Kind::time, .function = std::move(function)});
}

AffineSum FormulaBuilder::time() { return function_of_time(time_itself()); }

bool FormulaBuilder::is_of_time(const AffineSum& x) const {
  return std::all_of(x.terms.begin(), x.terms.end(), [&](const auto& term) {
    const FormulaPart& part = parts_[static_cast<std::size_t>(term.first)];
    return oscillation_of(part) != nullptr || is_time_itself(part);
  });
}

std::optional<FormulaBuilder::Line> FormulaBuilder::line_in_time(const AffineSum& x) const {
  if (x.terms.size() != 1 || !is_time_itself(parts_[static_cast<std::size_t>(x.terms[0].first)])) return std::nullopt;
  const double slope = x.terms[0].second;
  return Line{slope, -x.constant / slope};
}

bool FormulaBuilder::rises_from_zero(const AffineSum& x) const {
  const auto line = line_in_time(x);
  return line && line->slope > 0.0 && x.constant >= 0.0;
}

/// The points in time are those of the table, in reverse where the line falls; time before 0 does not count.
AffineSum FormulaBuilder::table_of_time(const Line& line, const std::vector<TablePoint>& points, bool extrapolated) {
  std::vector<TablePoint> track;
  for (const TablePoint& point : points) track.push_back({line.zero + point.x / line.slope, point.y});
  if (line.slope < 0.0) std::reverse(track.begin(), track.end());
  if (extrapolated && track.size() > 1) {
    const auto last = track.size() - 1;
    const TablePoint end = at(track[last - 1], track[last], far_future);
    if (track.front().x > 0.0) track.front() = at(track[0], track[1], 0.0);
    track.back() = end;
  }
  std::size_t first = 0;
  while (first + 1 < track.size() && track[first + 1].x < 0.0) ++first;
  track.erase(track.begin(), track.begin() + static_cast<std::ptrdiff_t>(first));
  if (track.front().x < 0.0) track.front() = track.size() > 1 ? at(track[0], track[1], 0.0) : TablePoint{0.0, track[0].y};
  const bool level = std::all_of(track.begin(), track.end(), [&](const TablePoint& p) { return p.y == track[0].y; });
  if (level) return constant_sum(track[0].y);
  model::Pwl pwl;
  for (const TablePoint& point : track) pwl.points.push_back({point.x, point.y});
  return function_of_time(std::move(pwl));
}

AffineSum FormulaBuilder::oscillation(double amplitude, double omega, double damping, double phase) {
  if (omega < 0.0) {
    omega = -omega;
    phase = half_turn - phase;
  }
  if (omega == 0.0 && damping == 0.0) return constant_sum(amplitude * std::sin(phase));
  if (omega == 0.0) {
    amplitude *= std::sin(phase);
    phase = 0.5 * half_turn;
  }
  model::Sin function;
  function.amplitude = 1.0;
  function.frequency = omega / (2.0 * half_turn);
  function.damping = damping;
  function.phase = std::remainder(phase, 2.0 * half_turn);
  return amplitude * function_of_time(function);
}

std::optional<AffineSum> FormulaBuilder::sine(const AffineSum& x, double phase) {
  if (x.is_constant()) return constant_sum(std::sin(x.constant + phase));
  if (!line_in_time(x)) return std::nullopt;
  return oscillation(1.0, x.terms[0].second, 0.0, x.constant + phase);
}

std::optional<AffineSum> FormulaBuilder::exponential(const AffineSum& x) {
  if (x.is_constant()) return constant_sum(std::exp(x.constant));
  if (!line_in_time(x)) return std::nullopt;
  return oscillation(std::exp(x.constant), 0.0, -x.terms[0].second, 0.5 * half_turn);
}

/// From its value at time 0 to the first corner, then between the corners for ever.
std::optional<AffineSum> FormulaBuilder::arc_sine(const AffineSum& x) {
  if (x.is_constant()) return constant_sum(std::asin(x.constant));
  if (x.constant != 0.0 || x.terms.size() != 1 || std::abs(x.terms[0].second) != 1.0) return std::nullopt;
  const model::Sin* wave = oscillation_of(parts_[static_cast<std::size_t>(x.terms[0].first)]);
  if (wave == nullptr || wave->damping != 0.0 || wave->delay != 0.0 || wave->offset != 0.0 || std::abs(wave->amplitude) != 1.0 ||
      std::isfinite(wave->cycles))
    return std::nullopt;
  const double period = 1.0 / wave->frequency, corner = 0.5 * half_turn;
  const double turns = (wave->phase - corner) / half_turn;  // half turns since the last corner
  const double behind = turns - std::floor(turns);
  const bool falls = std::remainder(std::floor(turns), 2.0) == 0.0;  // behind a corner at +π/2
  const double last = falls ? corner : -corner;
  const double begin = last * (1.0 - 2.0 * behind), first = 0.5 * period * (1.0 - behind);
  model::Pwl triangle;
  triangle.points = {{0.0, begin}, {first, -last}, {first + 0.5 * period, last}, {first + period, -last}};
  triangle.repeats = model::forever;
  triangle.repeat_from = first;
  return x.terms[0].second * wave->amplitude * function_of_time(std::move(triangle));
}

/// sin α · sin β = ½ (cos(α − β) − cos(α + β)), dampings added.
std::optional<AffineSum> FormulaBuilder::product_of_parts(int a, int b) {
  const model::Sin* first = oscillation_of(parts_[static_cast<std::size_t>(a)]);
  const model::Sin* second = oscillation_of(parts_[static_cast<std::size_t>(b)]);
  if (first == nullptr || second == nullptr) return std::nullopt;
  const double omega_a = 2.0 * half_turn * first->frequency, omega_b = 2.0 * half_turn * second->frequency;
  const double phase_a = first->phase, phase_b = second->phase;
  const double damping = first->damping + second->damping;
  const double quarter = 0.5 * half_turn;
  return oscillation(0.5, omega_a - omega_b, damping, phase_a - phase_b + quarter) -
         oscillation(0.5, omega_a + omega_b, damping, phase_a + phase_b + quarter);
}

/// The sawtooth rises from the fraction that x has at time 0 to its first whole number, and then from 0 to 1 for ever.
std::optional<AffineSum> FormulaBuilder::floor(const AffineSum& x) {
  if (x.is_constant()) return constant_sum(std::floor(x.constant));
  const auto line = line_in_time(x);
  if (!line) return std::nullopt;
  const double begin = std::abs(x.constant - std::round(x.constant)) < whole_number ? 0.0 : x.constant - std::floor(x.constant);
  const double period = 1.0 / std::abs(line->slope);
  const bool rises = line->slope > 0.0;
  const double first = (rises ? 1.0 - begin : begin) * period;
  const double from = rises ? 0.0 : 1.0, to = rises ? 1.0 : 0.0;
  model::Pwl saw;
  if (first > 0.0) saw.points = {{0.0, begin}, {first, to}};
  saw.points.push_back({first, from});
  saw.points.push_back({first + period, to});
  saw.repeats = model::forever;
  saw.repeat_from = first;
  return x - function_of_time(std::move(saw));
}

std::optional<AffineSum> FormulaBuilder::product_of_time(const AffineSum& a, const AffineSum& b) {
  if (!is_of_time(a) || !is_of_time(b)) return std::nullopt;
  AffineSum sum = constant_sum(a.constant * b.constant);
  for (const auto& [part, coefficient] : a.terms) sum = sum + AffineSum{0.0, {{part, b.constant * coefficient}}};
  for (const auto& [part, coefficient] : b.terms) sum = sum + AffineSum{0.0, {{part, a.constant * coefficient}}};
  for (const auto& [i, x] : a.terms)
    for (const auto& [j, y] : b.terms) {
      const std::optional<AffineSum> part = product_of_parts(i, j);
      if (!part) return std::nullopt;
      sum = sum + x * y * *part;
    }
  std::erase_if(sum.terms, [](const auto& term) { return term.second == 0.0; });
  return sum;
}

}  // namespace pwlsim::elements
