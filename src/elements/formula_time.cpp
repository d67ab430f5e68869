/// Functions of time alone: sums of constants, exponentials, sinusoids and one straight line, closed under products where that is possible.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "elements/formula.hpp"

namespace pwlsim::elements {
namespace {

using PartKind = FormulaPart::Kind;

constexpr double half_turn = std::numbers::pi;
/// `time` itself is a PWL source that rises to here: later than any run.
constexpr double far_future = 1e15;
/// So near to a whole number a line begins at it.
constexpr double whole_number = 1e-12;

const model::Sin* oscillation_of(const FormulaPart& part) {
  return part.kind == PartKind::time ? std::get_if<model::Sin>(&part.function) : nullptr;
}

model::Pwl time_itself() { return {{{0.0, 0.0}, {far_future, far_future}}, 0.0, 0.0}; }

bool is_time_itself(const FormulaPart& part) {
  return part.kind == PartKind::time && part.function == model::SourceFunction(time_itself());
}

/// The point of the line through a and b at time t.
TablePoint at(const TablePoint& a, const TablePoint& b, double t) { return {t, a.y + (b.y - a.y) / (b.x - a.x) * (t - a.x)}; }

/// A number of a function of time, with its derivatives.
template <class Function>
Varied number_of(const FormulaPart& part, double Function::*member) {
  Varied number = std::get<Function>(part.function).*member;
  for (const auto& move : part.function_moves) number.gradient.push_back(move ? std::get<Function>(*move).*member : 0.0);
  return number;
}

std::size_t largest(std::initializer_list<const Varied*> numbers) {
  std::size_t size = 0;
  for (const Varied* number : numbers) size = std::max(size, number->gradient.size());
  return size;
}

/// The whole number below x, which is constant. A parameter that moves x from a whole number decides which.
AffineSum chosen_by_whole(const AffineSum& x) {
  Varied whole = std::floor(x.constant.value);
  if (whole.value != x.constant.value) return constant_sum(whole);
  whole = unfollowed(whole, x.constant);
  for (const auto& term : x.terms) whole = unfollowed(whole, term.second);
  return constant_sum(whole);
}

}  // namespace

AffineSum FormulaBuilder::function_of_time(model::SourceFunction function, std::size_t parameters,
                                           const std::function<model::SourceFunction(std::size_t)>& move) {
  FormulaPart own{.kind = PartKind::time, .function = std::move(function)};
  for (std::size_t k = 0; k < parameters; ++k) own.function_moves.emplace_back(move(k));
  return part(std::move(own));
}

AffineSum FormulaBuilder::lines_of_time(const std::vector<TablePoint>& points, const std::optional<Varied>& repeat_from) {
  std::size_t parameters = repeat_from ? repeat_from->gradient.size() : 0;
  for (const TablePoint& point : points) parameters = std::max({parameters, point.x.gradient.size(), point.y.gradient.size()});
  model::Pwl pwl;
  for (const TablePoint& point : points) pwl.points.push_back({point.x.value, point.y.value});
  if (repeat_from) {
    pwl.repeats = model::forever;
    pwl.repeat_from = repeat_from->value;
  }
  return function_of_time(pwl, parameters, [&](std::size_t k) {
    model::Pwl move = pwl;
    for (std::size_t i = 0; i < points.size(); ++i) move.points[i] = {points[i].x.moved(k), points[i].y.moved(k)};
    move.repeat_from = repeat_from ? repeat_from->moved(k) : 0.0;
    return move;
  });
}

TablePoint FormulaBuilder::corner_of(const FormulaPart& part, std::size_t number) {
  const auto of = [&](const model::SourceFunction& f) { return std::get<model::Pwl>(f).points[number]; };
  TablePoint corner{of(part.function).time, of(part.function).value};
  for (const auto& move : part.function_moves) {
    corner.x.gradient.push_back(move ? of(*move).time : 0.0);
    corner.y.gradient.push_back(move ? of(*move).value : 0.0);
  }
  return corner;
}

AffineSum FormulaBuilder::time() { return function_of_time(time_itself()); }

bool FormulaBuilder::is_of_time(const AffineSum& x) const {
  return std::all_of(x.terms.begin(), x.terms.end(), [&](const auto& term) {
    const FormulaPart& part = parts_[static_cast<std::size_t>(term.first)];
    return oscillation_of(part) != nullptr || is_time_itself(part);
  });
}

std::optional<FormulaBuilder::Line> FormulaBuilder::line_in_time(const AffineSum& x) const {
  if (x.terms.size() != 1 || x.is_constant() || !is_time_itself(parts_[static_cast<std::size_t>(x.terms[0].first)])) return std::nullopt;
  const Varied& slope = x.terms[0].second;
  return Line{slope, -x.constant / slope};
}

bool FormulaBuilder::rises_from_zero(const AffineSum& x) const {
  const auto line = line_in_time(x);
  return line && line->slope.value > 0.0 && x.constant.value >= 0.0;
}

/// The points in time are those of the table, in reverse where the line falls; time before 0 does not count.
AffineSum FormulaBuilder::table_of_time(const Line& line, const std::vector<TablePoint>& points, bool extrapolated) {
  std::vector<TablePoint> track;
  for (const TablePoint& point : points) track.push_back({line.zero + point.x / line.slope, point.y});
  if (line.slope.value < 0.0) std::reverse(track.begin(), track.end());
  if (extrapolated && track.size() > 1) {
    const auto last = track.size() - 1;
    const TablePoint end = at(track[last - 1], track[last], far_future);
    if (track.front().x.value > 0.0) track.front() = at(track[0], track[1], 0.0);
    track.back() = end;
  }
  std::size_t first = 0;
  while (first + 1 < track.size() && track[first + 1].x.value < 0.0) ++first;
  track.erase(track.begin(), track.begin() + static_cast<std::ptrdiff_t>(first));
  if (track.front().x.value < 0.0) track.front() = track.size() > 1 ? at(track[0], track[1], 0.0) : TablePoint{0.0, track[0].y};
  const bool level = std::all_of(track.begin(), track.end(), [&](const TablePoint& p) { return p.y == track[0].y; });
  return level ? constant_sum(track[0].y) : lines_of_time(track);
}

AffineSum FormulaBuilder::oscillation(const Varied& amplitude, Varied omega, const Varied& damping, Varied phase) {
  const auto sine_of = [](const Varied& x) { return applied(x, std::sin(x.value), std::cos(x.value)); };
  if (omega.value < 0.0) {
    omega = -omega;
    phase = half_turn - phase;
  }
  if (omega.value == 0.0) {
    // Where the frequency moves away from zero, so does the form.
    const Varied constant = unfollowed(amplitude * sine_of(phase), omega);
    if (damping.value == 0.0) return constant_sum(unfollowed(constant, damping));
    return damped(constant, 0.0, damping, 0.5 * half_turn);
  }
  return damped(amplitude, omega / (2.0 * half_turn), damping, applied(phase, std::remainder(phase.value, 2.0 * half_turn), 1.0));
}

AffineSum FormulaBuilder::damped(const Varied& amplitude, const Varied& frequency, const Varied& damping, const Varied& phase) {
  model::Sin function;
  function.amplitude = 1.0;
  function.frequency = frequency.value;
  function.damping = damping.value;
  function.phase = phase.value;
  return amplitude * function_of_time(function, largest({&frequency, &damping, &phase}), [&](std::size_t k) {
           return model::Sin{0.0, 0.0, frequency.moved(k), 0.0, damping.moved(k), phase.moved(k), 0.0};
         });
}

std::optional<AffineSum> FormulaBuilder::sine(const AffineSum& x, const Varied& phase) {
  if (x.is_constant()) {
    const Varied angle = x.constant + phase;
    const double sine = std::sin(angle.value), slope = std::cos(angle.value);
    return constant_sum(applied(angle, sine, slope)) + slope * AffineSum{0.0, x.terms};
  }
  if (!line_in_time(x)) return std::nullopt;
  return oscillation(1.0, x.terms[0].second, 0.0, x.constant + phase);
}

std::optional<AffineSum> FormulaBuilder::exponential(const AffineSum& x) {
  const double value = std::exp(x.constant.value);
  if (x.is_constant()) return constant_sum(applied(x.constant, value, value)) + value * AffineSum{0.0, x.terms};
  if (!line_in_time(x)) return std::nullopt;
  return oscillation(applied(x.constant, value, value), 0.0, -x.terms[0].second, 0.5 * half_turn);
}

/// From its value at time 0 to the first corner, then between the corners for ever.
std::optional<AffineSum> FormulaBuilder::arc_sine(const AffineSum& x) {
  if (x.is_constant()) {
    const double value = std::asin(x.constant.value), slope = 1.0 / std::sqrt(1.0 - x.constant.value * x.constant.value);
    return constant_sum(applied(x.constant, value, slope)) + slope * AffineSum{0.0, x.terms};
  }
  if (x.constant.value != 0.0 || x.terms.size() != 1 || std::abs(x.terms[0].second.value) != 1.0) return std::nullopt;
  const FormulaPart inner = parts_[static_cast<std::size_t>(x.terms[0].first)];
  const model::Sin* wave = oscillation_of(inner);
  if (wave == nullptr || wave->damping != 0.0 || wave->delay != 0.0 || wave->offset != 0.0 || std::abs(wave->amplitude) != 1.0 ||
      std::isfinite(wave->cycles))
    return std::nullopt;
  const Varied period = 1.0 / number_of(inner, &model::Sin::frequency);
  const double corner = 0.5 * half_turn;
  const Varied turns = 1.0 / half_turn * (number_of(inner, &model::Sin::phase) - corner);  // half turns since the last corner
  const Varied behind = turns - std::floor(turns.value);
  const bool falls = std::remainder(std::floor(turns.value), 2.0) == 0.0;  // behind a corner at +π/2
  const double last = falls ? corner : -corner;
  const Varied begin = last * (1.0 - 2.0 * behind), first = 0.5 * period * (1.0 - behind);
  const AffineSum triangle = lines_of_time({{0.0, begin}, {first, -last}, {first + 0.5 * period, last}, {first + period, -last}}, first);
  AffineSum result = x.terms[0].second.value * wave->amplitude * triangle;
  result.constant = unfollowed(unfollowed(result.constant, x.constant), x.terms[0].second);
  return result;
}

/// sin α · sin β = ½ (cos(α − β) − cos(α + β)), dampings added.
std::optional<AffineSum> FormulaBuilder::product_of_parts(int a, int b) {
  const FormulaPart first = parts_[static_cast<std::size_t>(a)], second = parts_[static_cast<std::size_t>(b)];
  if (oscillation_of(first) == nullptr || oscillation_of(second) == nullptr) return std::nullopt;
  const auto of_both = [&](double model::Sin::*member) { return std::pair(number_of(first, member), number_of(second, member)); };
  const auto [frequency_a, frequency_b] = of_both(&model::Sin::frequency);
  const auto [phase_a, phase_b] = of_both(&model::Sin::phase);
  const auto [damping_a, damping_b] = of_both(&model::Sin::damping);
  const Varied omega_a = 2.0 * half_turn * frequency_a, omega_b = 2.0 * half_turn * frequency_b, damping = damping_a + damping_b;
  const double quarter = 0.5 * half_turn;
  return oscillation(0.5, omega_a - omega_b, damping, phase_a - phase_b + quarter) -
         oscillation(0.5, omega_a + omega_b, damping, phase_a + phase_b + quarter);
}

/// The sawtooth rises from the fraction that x has at time 0 to its first whole number, and then from 0 to 1 for ever.
std::optional<AffineSum> FormulaBuilder::floor(const AffineSum& x) {
  if (x.is_constant()) return chosen_by_whole(x);
  const auto line = line_in_time(x);
  if (!line) return std::nullopt;
  const double constant = x.constant.value;
  // A begin that is whole stays whole: the first piece, which a parameter might add, is none.
  const bool is_whole = std::abs(constant - std::round(constant)) < whole_number;
  const Varied begin = is_whole ? unfollowed(0.0, x.constant) : x.constant - std::floor(constant);
  const Varied period = line->slope.value > 0.0 ? 1.0 / line->slope : -1.0 / line->slope;
  const bool rises = line->slope.value > 0.0;
  const Varied first = (rises ? 1.0 - begin : begin) * period;
  const double from = rises ? 0.0 : 1.0, to = rises ? 1.0 : 0.0;
  std::vector<TablePoint> saw;
  if (first.value > 0.0) saw = {{0.0, begin}, {first, to}};
  saw.push_back({first, from});
  saw.push_back({first + period, to});
  return x - lines_of_time(saw, first);
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
  std::erase_if(sum.terms, [](const auto& term) { return term.second.is_nothing(); });
  return sum;
}

}  // namespace pwlsim::elements
