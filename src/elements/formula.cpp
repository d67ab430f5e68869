#include "elements/formula.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pwlsim::elements {
namespace {

using Kind = FormulaPart::Kind;

/// Coefficients that differ by less are equal but for the rounding of the arithmetic that made them.
constexpr double rounding = 1e-14;
constexpr double infinity = std::numeric_limits<double>::infinity();

AffineSum combine(const AffineSum& a, const AffineSum& b, double factor) {
  AffineSum sum{a.constant + factor * b.constant, {}};
  auto i = a.terms.begin();
  auto j = b.terms.begin();
  while (i != a.terms.end() || j != b.terms.end()) {
    if (j == b.terms.end() || (i != a.terms.end() && i->first < j->first)) {
      sum.terms.push_back(*i++);
    } else if (i == a.terms.end() || j->first < i->first) {
      sum.terms.emplace_back(j->first, factor * j->second);
      ++j;
    } else {
      const double coefficient = i->second + factor * j->second;
      if (std::abs(coefficient) > rounding * std::abs(i->second)) sum.terms.emplace_back(i->first, coefficient);
      ++i;
      ++j;
    }
  }
  return sum;
}

/// The ratio a/b of the parts with terms, where it is one number.
std::optional<double> ratio_of_terms(const AffineSum& a, const AffineSum& b) {
  if (a.terms.size() != b.terms.size() || b.terms.empty()) return std::nullopt;
  const double ratio = a.terms[0].second / b.terms[0].second;
  for (std::size_t k = 0; k < a.terms.size(); ++k) {
    const double rest = a.terms[k].second - ratio * b.terms[k].second;
    if (a.terms[k].first != b.terms[k].first || std::abs(rest) > rounding * std::abs(a.terms[k].second)) return std::nullopt;
  }
  return ratio;
}

/// Whether a single comparison holds where its margin rests at 0: its value is a step, or one less a step.
bool holds_at_zero(const AffineSum& value, const std::vector<FormulaPart>& parts) {
  if (value.terms.size() != 1) return false;
  const auto& [part, coefficient] = value.terms[0];
  return value.constant + coefficient * parts[static_cast<std::size_t>(part)].at_zero > 0.5;
}

bool is_bound(const AffineSum& x, double bound) { return x.is_constant() && x.constant == bound; }

/// Value at x of the lines through the points.
double table_value(const std::vector<TablePoint>& points, double x, bool extrapolated) {
  const auto slope = [&](std::size_t k) { return (points[k + 1].y - points[k].y) / (points[k + 1].x - points[k].x); };
  const std::size_t last = points.size() - 1;
  if (last == 0) return points[0].y;
  if (x < points[0].x) return extrapolated ? points[0].y + slope(0) * (x - points[0].x) : points[0].y;
  if (x >= points[last].x) return extrapolated ? points[last].y + slope(last - 1) * (x - points[last].x) : points[last].y;
  std::size_t k = 0;
  while (points[k + 1].x <= x) ++k;
  return points[k].y + slope(k) * (x - points[k].x);
}

}  // namespace

AffineSum constant_sum(double value) { return {value, {}}; }
AffineSum operator+(const AffineSum& a, const AffineSum& b) { return combine(a, b, 1.0); }
AffineSum operator-(const AffineSum& a, const AffineSum& b) { return combine(a, b, -1.0); }
AffineSum operator*(double factor, const AffineSum& a) {
  if (factor == 0.0) return {};
  AffineSum product = a;
  product.constant *= factor;
  for (auto& term : product.terms) term.second *= factor;
  return product;
}

AffineSum FormulaBuilder::part(FormulaPart part) {
  const auto found = std::find(parts_.begin(), parts_.end(), part);
  const auto index = static_cast<int>(found - parts_.begin());
  if (found == parts_.end()) parts_.push_back(std::move(part));
  return {0.0, {{index, 1.0}}};
}

AffineSum FormulaBuilder::positive(const AffineSum& x) {
  if (x.is_constant()) return constant_sum(std::max(x.constant, 0.0));
  if (const auto line = line_in_time(x)) {
    const AffineSum above = table_of_time({1.0, line->zero}, {{-1.0, 0.0}, {0.0, 0.0}, {1.0, 1.0}}, true);
    return line->slope > 0.0 ? line->slope * above : -line->slope * above + x;
  }
  const double lead = x.terms[0].second;
  const AffineSum normal = 1.0 / lead * x;
  const AffineSum above = part({.kind = Kind::positive, .argument = normal});
  return lead > 0.0 ? lead * above : -lead * above + x;
}

AffineSum FormulaBuilder::step(const AffineSum& x, double at_zero) {
  if (x.is_constant()) return constant_sum(x.constant > 0.0 ? 1.0 : (x.constant < 0.0 ? 0.0 : at_zero));
  if (const auto line = line_in_time(x)) {
    const AffineSum risen = table_of_time({1.0, 0.0}, {{line->zero, 0.0}, {line->zero, 1.0}}, false);
    return line->slope > 0.0 ? risen : constant_sum(1.0) - risen;
  }
  const double lead = x.terms[0].second;
  const AffineSum above = part({.kind = Kind::step, .argument = 1.0 / lead * x, .at_zero = lead > 0.0 ? at_zero : 1.0 - at_zero});
  return lead > 0.0 ? above : constant_sum(1.0) - above;
}

AffineSum FormulaBuilder::maximum(const AffineSum& a, const AffineSum& b) {
  if (is_bound(a, -infinity)) return b;
  return is_bound(b, -infinity) ? a : a + positive(b - a);
}

AffineSum FormulaBuilder::minimum(const AffineSum& a, const AffineSum& b) {
  if (is_bound(a, infinity)) return b;
  return is_bound(b, infinity) ? a : a - positive(a - b);
}

AffineSum FormulaBuilder::limit(const AffineSum& x, const AffineSum& a, const AffineSum& b) {
  const AffineSum span = b - a;
  if (span.is_constant()) {
    const AffineSum& low = span.constant >= 0.0 ? a : b;
    const AffineSum& high = span.constant >= 0.0 ? b : a;
    if (is_bound(low, -infinity)) return minimum(x, high);
    if (is_bound(high, infinity)) return maximum(x, low);
    return low + positive(x - low) - positive(x - high);
  }
  return maximum(minimum(a, b), minimum(maximum(a, b), x));
}

AffineSum FormulaBuilder::table(const AffineSum& x, const std::vector<TablePoint>& points, bool extrapolated) {
  if (x.is_constant()) return constant_sum(table_value(points, x.constant, extrapolated));
  if (const auto line = line_in_time(x)) return table_of_time(*line, points, extrapolated);
  const std::size_t last = points.size() - 1;
  std::vector<std::pair<double, double>> segments;  // start, slope; the lines between points of different x
  AffineSum jumps;
  for (std::size_t k = 0; k < last; ++k) {
    const double width = points[k + 1].x - points[k].x;
    const double rise = points[k + 1].y - points[k].y;
    if (width > 0.0)
      segments.emplace_back(points[k].x, rise / width);
    else if (rise != 0.0)
      jumps = jumps + rise * step(x - constant_sum(points[k].x));
  }
  AffineSum sum = constant_sum(points[0].y) + jumps;
  if (segments.empty()) return sum;
  double slope = extrapolated ? segments.front().second : 0.0;
  sum = sum + slope * (x - constant_sum(points[0].x));
  if (!extrapolated) segments.emplace_back(points[last].x, 0.0);
  for (const auto& [start, next] : segments) {
    const double change = next - slope;
    if (std::abs(change) > rounding * std::max(std::abs(slope), std::abs(next))) sum = sum + change * positive(x - constant_sum(start));
    slope = next;
  }
  return sum;
}

Condition FormulaBuilder::greater(const AffineSum& a, const AffineSum& b, bool or_equal) {
  const AffineSum margin = a - b;
  return {step(margin, or_equal ? 1.0 : 0.0), margin};
}

Condition FormulaBuilder::both(const Condition& a, const Condition& b) {
  return {positive(a.value + b.value - constant_sum(1.0)), std::nullopt};
}

Condition FormulaBuilder::either(const Condition& a, const Condition& b) {
  return {a.value + b.value - positive(a.value + b.value - constant_sum(1.0)), std::nullopt};
}

Condition FormulaBuilder::negation(const Condition& a) {
  Condition result{constant_sum(1.0) - a.value, std::nullopt};
  if (a.margin) result.margin = -1.0 * *a.margin;
  return result;
}

AffineSum FormulaBuilder::choose(const Condition& condition, const AffineSum& yes, const AffineSum& no) {
  if (condition.is_constant()) return condition.holds() ? yes : no;
  const AffineSum difference = yes - no;
  if (difference.is_constant()) return no + difference.constant * condition.value;
  if (!condition.margin) return hysteresis(condition.value, 0.5, 0.5, yes, no);
  const AffineSum& margin = *condition.margin;
  const std::optional<double> ratio = ratio_of_terms(difference, margin);
  if (!ratio && holds_at_zero(condition.value, parts_)) return hysteresis(-1.0 * margin, 0.0, 0.0, no, yes);
  if (!ratio) return hysteresis(margin, 0.0, 0.0, yes, no);
  const double jump = difference.constant - *ratio * margin.constant;
  const bool is_continuous = std::abs(jump) <= rounding * std::abs(difference.constant);
  return no + *ratio * positive(margin) + (is_continuous ? 0.0 : jump) * condition.value;
}

AffineSum FormulaBuilder::hysteresis(const AffineSum& control, double on_level, double off_level, const AffineSum& above,
                                     const AffineSum& below) {
  if (control.is_constant()) return control.constant > on_level ? above : below;
  return part({.kind = Kind::choice, .argument = control, .above = above, .below = below, .on_level = on_level, .off_level = off_level});
}

AffineSum FormulaBuilder::integral(const AffineSum& x, double start) {
  if (x.is_constant() && x.constant == 0.0) return constant_sum(start);
  return part({.kind = Kind::integral, .argument = x, .start = start});
}

AffineSum FormulaBuilder::integral(const AffineSum& x, double start, const Condition& held) {
  if (held.is_constant()) return held.holds() ? constant_sum(start) : integral(x, start);
  if (held.margin && !holds_at_zero(held.value, parts_)) return held_integral(x, start, *held.margin, 0.0);
  return held_integral(x, start, held.value, 0.5);
}

AffineSum FormulaBuilder::held_integral(const AffineSum& x, double start, const AffineSum& control, double level) {
  if (control.is_constant()) return control.constant > level ? constant_sum(start) : integral(x, start);
  return part({.kind = Kind::integral, .argument = x, .above = control, .on_level = level, .start = start, .is_held = true});
}

std::optional<AffineSum> FormulaBuilder::wrapped_integral(const AffineSum& x, double start, double from, double to) {
  const double width = to - from;
  if (x.is_constant()) {
    const AffineSum line = constant_sum(start) + x.constant * time();
    const std::optional<AffineSum> turns = floor(1.0 / width * (line - constant_sum(from)));
    return turns ? std::optional(line - width * *turns) : std::nullopt;
  }
  const double begin = start - width * std::floor((start - from) / width);
  return part({.kind = Kind::integral, .argument = x, .start = begin, .from = from, .to = to});
}

std::optional<AffineSum> FormulaBuilder::derivative(const AffineSum& x) {
  AffineSum rest, sum;
  for (const auto& [index, coefficient] : x.terms) {
    const FormulaPart inner = parts_[static_cast<std::size_t>(index)];
    if (inner.kind == Kind::step || inner.kind == Kind::choice || inner.is_held || inner.from != inner.to) return std::nullopt;
    if (inner.kind == Kind::positive) {
      const std::optional<AffineSum> slope = derivative(inner.argument);
      if (!slope) return std::nullopt;
      sum = sum + coefficient * hysteresis(inner.argument, 0.0, 0.0, *slope, {});
    } else if (inner.kind == Kind::integral) {
      sum = sum + coefficient * inner.argument;
    } else {
      rest.terms.emplace_back(index, coefficient);
    }
  }
  if (rest.is_constant()) return sum;
  if (const auto line = line_in_time(rest)) return sum + constant_sum(line->slope);
  return sum + part({.kind = Kind::derivative, .argument = rest});
}

AffineSum FormulaBuilder::transfer(const AffineSum& x, const Fraction& fraction) {
  if (fraction.den.size() == 1) return fraction.num.back() / fraction.den[0] * x;
  return part({.kind = Kind::transfer, .argument = x, .fraction = fraction});
}

std::optional<FormulaBuilder::TwoValued> FormulaBuilder::two_valued(int index) {
  const FormulaPart part = parts_[static_cast<std::size_t>(index)];
  const AffineSum itself{0.0, {{index, 1.0}}};
  if (part.kind == Kind::step) return TwoValued{{itself, part.argument}, 0.0, 1.0};
  const auto between = [&](double below, double above, const AffineSum& margin) {
    return TwoValued{{1.0 / (above - below) * (itself - constant_sum(below)), margin}, below, above};
  };
  if (part.kind == Kind::voltage && levels_) {
    const std::optional<Levels> levels = levels_(part.index);
    if (!levels || levels->low == levels->high) return std::nullopt;
    return between(levels->low, levels->high, itself - constant_sum(0.5 * (levels->low + levels->high)));
  }
  const auto* pwl = part.kind == Kind::time ? std::get_if<model::Pwl>(&part.function) : nullptr;
  if (pwl == nullptr || pwl->repeats > 0.0 || pwl->points.size() != 2 || pwl->points[0].time != pwl->points[1].time) return std::nullopt;
  return between(pwl->points[0].value, pwl->points[1].value, time() - constant_sum(pwl->points[0].time));
}

std::optional<AffineSum> FormulaBuilder::switched(int index, const Values& of_value) {
  if (const std::optional<TwoValued> values = two_valued(index)) {
    const std::optional<AffineSum> above = of_value(constant_sum(values->above)), below = of_value(constant_sum(values->below));
    if (!above || !below) return std::nullopt;
    return choose(values->condition, *above, *below);
  }
  const FormulaPart part = parts_[static_cast<std::size_t>(index)];
  if (part.kind == Kind::voltage && levels_) {
    const std::optional<Levels> levels = levels_(part.index);
    return levels ? of_value(constant_sum(levels->low)) : std::nullopt;
  }
  if (part.kind != Kind::choice) return std::nullopt;
  const std::optional<AffineSum> above = of_value(part.above), below = of_value(part.below);
  if (!above || !below) return std::nullopt;
  return hysteresis(part.argument, part.on_level, part.off_level, *above, *below);
}

std::optional<AffineSum> FormulaBuilder::reciprocal(const AffineSum& x) {
  if (x.is_constant()) return x.constant == 0.0 ? std::nullopt : std::optional(constant_sum(1.0 / x.constant));
  constexpr std::size_t most_parts = 4;
  if (x.terms.size() > most_parts) return std::nullopt;
  const auto [part, coefficient] = x.terms.back();
  AffineSum rest = x;
  rest.terms.pop_back();
  return switched(part, [&, factor = coefficient](const AffineSum& value) { return reciprocal(rest + factor * value); });
}

std::optional<AffineSum> FormulaBuilder::switched_sum(const AffineSum& a, const AffineSum& x) {
  AffineSum sum = a.constant * x;
  for (const auto& [part, coefficient] : a.terms) {
    const std::optional<AffineSum> product = switched(part, [&](const AffineSum& value) { return this->product(value, x); });
    if (!product) return std::nullopt;
    sum = sum + coefficient * *product;
  }
  return sum;
}

std::optional<AffineSum> FormulaBuilder::product(const AffineSum& a, const AffineSum& b) {
  if (a.is_constant()) return a.constant * b;
  if (b.is_constant()) return b.constant * a;
  if (auto product = product_of_time(a, b)) return product;
  if (auto product = switched_sum(a, b)) return product;
  return switched_sum(b, a);
}

}  // namespace pwlsim::elements
