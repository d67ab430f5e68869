#include "elements/formula.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pwlsim::elements {
namespace {

using PartKind = FormulaPart::Kind;

/// Coefficients that differ by less are equal but for the rounding of the arithmetic that made them.
constexpr double coefficient_rounding = 1e-14;
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
      Varied coefficient = i->second + factor * j->second;
      if (!(std::abs(coefficient.value) > coefficient_rounding * std::abs(i->second.value))) coefficient.value = 0.0;
      if (!coefficient.is_nothing()) sum.terms.emplace_back(i->first, std::move(coefficient));
      ++i;
      ++j;
    }
  }
  return sum;
}

/// The first coefficient of a sum that is not constant.
const Varied& lead_of(const AffineSum& x) {
  return std::find_if(x.terms.begin(), x.terms.end(), [](const auto& term) { return term.second.value != 0.0; })->second;
}

/// The ratio a/b of the parts with terms, where it is one number.
std::optional<Varied> ratio_of_terms(const AffineSum& a, const AffineSum& b) {
  if (a.terms.size() != b.terms.size() || b.terms.empty()) return std::nullopt;
  const auto is_zero = [](const auto& term) { return term.second.value == 0.0; };
  if (std::any_of(a.terms.begin(), a.terms.end(), is_zero) || std::any_of(b.terms.begin(), b.terms.end(), is_zero)) return std::nullopt;
  const Varied ratio = a.terms[0].second / b.terms[0].second;
  for (std::size_t k = 0; k < a.terms.size(); ++k) {
    const Varied rest = a.terms[k].second - ratio * b.terms[k].second;
    if (a.terms[k].first != b.terms[k].first || std::abs(rest.value) > coefficient_rounding * std::abs(a.terms[k].second.value) ||
        rest.moves())
      return std::nullopt;
  }
  return ratio;
}

/// Whether a single comparison holds where its margin rests at 0: its value is a step, or one less a step.
bool holds_at_zero(const AffineSum& value, const std::vector<FormulaPart>& parts) {
  if (value.terms.size() != 1) return false;
  const auto& [part, coefficient] = value.terms[0];
  return value.constant.value + coefficient.value * parts[static_cast<std::size_t>(part)].at_zero > 0.5;
}

bool is_bound(const AffineSum& x, double bound) { return x.is_number() && x.constant.value == bound; }

/// A number with NaN for each parameter that gives x terms, or moves its constant.
Varied unfollowed_by(const AffineSum& x, Varied number) {
  number = unfollowed(number, x.constant);
  for (const auto& term : x.terms) number = unfollowed(number, term.second);
  return number;
}

/// `chosen`, because x lies on one side of a level; where it lies on it a parameter that moves it decides.
AffineSum chosen_by(const AffineSum& x, double level, AffineSum chosen) {
  if (x.constant.value == level && x.moves()) chosen.constant = unfollowed_by(x, std::move(chosen.constant));
  return chosen;
}

/// The rise at two points of one x. A parameter that moves them apart makes a line of it.
Varied unfollowed_slope(const Varied& rise, const Varied& width) { return width.moves() ? unfollowed(rise, width) : rise; }

/// The lines through the points, at an x that is constant.
AffineSum table_at(const std::vector<TablePoint>& points, const AffineSum& x, bool extrapolated) {
  const auto on_line = [&](std::size_t k, std::size_t of) {
    const Varied slope = (points[of + 1].y - points[of].y) / (points[of + 1].x - points[of].x);
    return constant_sum(points[k].y) + slope * (x - constant_sum(points[k].x));
  };
  const std::size_t last = points.size() - 1;
  const double at = x.constant.value;
  AffineSum value;
  if (last == 0) return constant_sum(points[0].y);
  if (at < points[0].x.value) {
    value = extrapolated ? on_line(0, 0) : constant_sum(points[0].y);
  } else if (at >= points[last].x.value) {
    value = extrapolated ? on_line(last, last - 1) : constant_sum(points[last].y);
  } else {
    std::size_t k = 0;
    while (points[k + 1].x.value <= at) ++k;
    value = on_line(k, k);
  }
  for (const TablePoint& point : points) value = chosen_by(x - constant_sum(point.x), 0.0, std::move(value));
  return value;
}

}  // namespace

AffineSum constant_sum(Varied value) { return {std::move(value), {}}; }
AffineSum operator+(const AffineSum& a, const AffineSum& b) { return combine(a, b, 1.0); }
AffineSum operator-(const AffineSum& a, const AffineSum& b) { return combine(a, b, -1.0); }
AffineSum operator*(const Varied& factor, const AffineSum& a) {
  if (factor.is_nothing()) return {};
  AffineSum product = a;
  product.constant = factor * a.constant;
  for (auto& term : product.terms) term.second = factor * term.second;
  std::erase_if(product.terms, [](const auto& term) { return term.second.is_nothing(); });
  return product;
}

AffineSum FormulaBuilder::part(FormulaPart part) {
  const auto found = std::find(parts_.begin(), parts_.end(), part);
  const auto index = static_cast<int>(found - parts_.begin());
  if (found == parts_.end()) parts_.push_back(std::move(part));
  return {0.0, {{index, 1.0}}};
}

AffineSum FormulaBuilder::positive(const AffineSum& x) {
  if (x.is_constant()) return chosen_by(x, 0.0, x.constant.value > 0.0 ? x : AffineSum{});
  if (const auto line = line_in_time(x)) {
    const AffineSum above = table_of_time({1.0, line->zero}, {{-1.0, 0.0}, {0.0, 0.0}, {1.0, 1.0}}, true);
    return line->slope.value > 0.0 ? line->slope * above : -line->slope * above + x;
  }
  const Varied lead = lead_of(x);
  const AffineSum normal = 1.0 / lead * x;
  const AffineSum above = part({.kind = PartKind::positive, .argument = normal});
  return lead.value > 0.0 ? lead * above : -lead * above + x;
}

AffineSum FormulaBuilder::step(const AffineSum& x, double at_zero) {
  if (x.is_constant()) {
    const double constant = x.constant.value;
    return chosen_by(x, 0.0, constant_sum(constant > 0.0 ? 1.0 : (constant < 0.0 ? 0.0 : at_zero)));
  }
  if (const auto line = line_in_time(x)) {
    const AffineSum risen = table_of_time({1.0, 0.0}, {{line->zero, 0.0}, {line->zero, 1.0}}, false);
    return line->slope.value > 0.0 ? risen : constant_sum(1.0) - risen;
  }
  const Varied lead = lead_of(x);
  const AffineSum above = part({.kind = PartKind::step, .argument = 1.0 / lead * x, .at_zero = lead.value > 0.0 ? at_zero : 1.0 - at_zero});
  return lead.value > 0.0 ? above : constant_sum(1.0) - above;
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
    const AffineSum& low = span.constant.value >= 0.0 ? a : b;
    const AffineSum& high = span.constant.value >= 0.0 ? b : a;
    if (is_bound(low, -infinity)) return minimum(x, high);
    if (is_bound(high, infinity)) return maximum(x, low);
    return low + positive(x - low) - positive(x - high);
  }
  return maximum(minimum(a, b), minimum(maximum(a, b), x));
}

AffineSum FormulaBuilder::table(const AffineSum& x, const std::vector<TablePoint>& points, bool extrapolated) {
  if (x.is_constant()) return table_at(points, x, extrapolated);
  if (const auto line = line_in_time(x)) return table_of_time(*line, points, extrapolated);
  const std::size_t last = points.size() - 1;
  std::vector<std::pair<Varied, Varied>> segments;  // start, slope; the lines between points of different x
  AffineSum jumps;
  for (std::size_t k = 0; k < last; ++k) {
    const Varied width = points[k + 1].x - points[k].x;
    const Varied rise = points[k + 1].y - points[k].y;
    if (width.value > 0.0)
      segments.emplace_back(points[k].x, rise / width);
    else if (!rise.is_nothing())
      jumps = jumps + unfollowed_slope(rise, width) * step(x - constant_sum(points[k].x));
  }
  AffineSum sum = constant_sum(points[0].y) + jumps;
  if (segments.empty()) return sum;
  Varied slope = extrapolated ? segments.front().second : Varied();
  sum = sum + slope * (x - constant_sum(points[0].x));
  if (!extrapolated) segments.emplace_back(points[last].x, Varied());
  for (const auto& [start, next] : segments) {
    Varied change = next - slope;
    if (!(std::abs(change.value) > coefficient_rounding * std::max(std::abs(slope.value), std::abs(next.value)))) change.value = 0.0;
    if (!change.is_nothing()) sum = sum + change * positive(x - constant_sum(start));
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
  if (condition.is_constant()) {
    AffineSum chosen = condition.holds() ? yes : no;
    if (condition.value.moves()) chosen.constant = unfollowed_by(condition.value, std::move(chosen.constant));
    return chosen;
  }
  const AffineSum difference = yes - no;
  if (difference.is_number()) return no + difference.constant * condition.value;
  if (!condition.margin) return hysteresis(condition.value, 0.5, 0.5, yes, no);
  const AffineSum& margin = *condition.margin;
  const std::optional<Varied> ratio = ratio_of_terms(difference, margin);
  if (!ratio && holds_at_zero(condition.value, parts_)) return hysteresis(-1.0 * margin, 0.0, 0.0, no, yes);
  if (!ratio) return hysteresis(margin, 0.0, 0.0, yes, no);
  Varied jump = difference.constant - *ratio * margin.constant;
  if (std::abs(jump.value) <= coefficient_rounding * std::abs(difference.constant.value)) jump.value = 0.0;
  return no + *ratio * positive(margin) + jump * condition.value;
}

AffineSum FormulaBuilder::hysteresis(const AffineSum& control, const Varied& on_level, const Varied& off_level, const AffineSum& above,
                                     const AffineSum& below) {
  if (control.is_constant())
    return chosen_by(control - constant_sum(on_level), 0.0, control.constant.value > on_level.value ? above : below);
  return part(
      {.kind = PartKind::choice, .argument = control, .above = above, .below = below, .on_level = on_level, .off_level = off_level});
}

AffineSum FormulaBuilder::integral(const AffineSum& x, const Varied& start) {
  if (x.is_number() && x.constant.is_nothing()) return constant_sum(start);
  return part({.kind = PartKind::integral, .argument = x, .start = start});
}

AffineSum FormulaBuilder::integral(const AffineSum& x, const Varied& start, const Condition& held) {
  if (held.is_constant()) return held.holds() ? constant_sum(start) : integral(x, start);
  if (held.margin && !holds_at_zero(held.value, parts_)) return held_integral(x, start, *held.margin, 0.0);
  return held_integral(x, start, held.value, 0.5);
}

AffineSum FormulaBuilder::held_integral(const AffineSum& x, const Varied& start, const AffineSum& control, const Varied& level) {
  if (control.is_constant())
    return chosen_by(control - constant_sum(level), 0.0, control.constant.value > level.value ? constant_sum(start) : integral(x, start));
  return part({.kind = PartKind::integral, .argument = x, .above = control, .on_level = level, .start = start, .is_held = true});
}

/// Of signals the range is not followed.
std::optional<AffineSum> FormulaBuilder::wrapped_integral(const AffineSum& x, const Varied& start, const Varied& from, const Varied& to) {
  const Varied width = to - from;
  if (x.is_constant()) {
    const AffineSum line = constant_sum(start) + x.constant * time();
    const std::optional<AffineSum> turns = floor(1.0 / width * (line - constant_sum(from)));
    return turns ? std::optional(line - width * *turns) : std::nullopt;
  }
  const Varied begin = start - width * std::floor((start.value - from.value) / width.value);
  return part(
      {.kind = PartKind::integral, .argument = x, .start = unfollowed(unfollowed(begin, from), width), .from = from.value, .to = to.value});
}

std::optional<AffineSum> FormulaBuilder::derivative(const AffineSum& x) {
  AffineSum rest, sum;
  for (const auto& [index, coefficient] : x.terms) {
    const FormulaPart inner = parts_[static_cast<std::size_t>(index)];
    if (inner.kind == PartKind::step || inner.kind == PartKind::choice || inner.is_held || inner.from != inner.to) return std::nullopt;
    if (inner.kind == PartKind::positive) {
      const std::optional<AffineSum> slope = derivative(inner.argument);
      if (!slope) return std::nullopt;
      sum = sum + coefficient * hysteresis(inner.argument, 0.0, 0.0, *slope, {});
    } else if (inner.kind == PartKind::integral) {
      sum = sum + coefficient * inner.argument;
    } else {
      rest.terms.emplace_back(index, coefficient);
    }
  }
  if (rest.is_number()) return sum;
  if (const auto line = line_in_time(rest)) return sum + constant_sum(line->slope);
  return sum + part({.kind = PartKind::derivative, .argument = rest});
}

AffineSum FormulaBuilder::transfer(const AffineSum& x, const RationalFunction& fraction) {
  if (fraction.den.size() == 1) return fraction.num.back() / fraction.den[0] * x;
  return part({.kind = PartKind::transfer, .argument = x, .fraction = fraction});
}

std::optional<FormulaBuilder::TwoValued> FormulaBuilder::two_valued(int index) {
  const FormulaPart part = parts_[static_cast<std::size_t>(index)];
  const AffineSum itself{0.0, {{index, 1.0}}};
  if (part.kind == PartKind::step) return TwoValued{{itself, part.argument}, 0.0, 1.0};
  const auto between = [&](const Varied& below, const Varied& above, const AffineSum& margin) {
    return TwoValued{{1.0 / (above - below) * (itself - constant_sum(below)), margin}, below, above};
  };
  if (part.kind == PartKind::voltage && levels_) {
    const std::optional<Levels> levels = levels_(part.index);
    if (!levels || levels->low == levels->high) return std::nullopt;
    return between(levels->low, levels->high, itself - constant_sum(0.5 * (levels->low + levels->high)));
  }
  const auto* pwl = part.kind == PartKind::time ? std::get_if<model::Pwl>(&part.function) : nullptr;
  if (pwl == nullptr || pwl->repeats > 0.0 || pwl->points.size() != 2 || pwl->points[0].time != pwl->points[1].time) return std::nullopt;
  const TablePoint first = corner_of(part, 0), second = corner_of(part, 1);
  return between(first.y, second.y, time() - constant_sum(first.x));
}

std::optional<AffineSum> FormulaBuilder::switched(int index, const Values& of_value) {
  if (const std::optional<TwoValued> values = two_valued(index)) {
    const std::optional<AffineSum> above = of_value(constant_sum(values->above)), below = of_value(constant_sum(values->below));
    if (!above || !below) return std::nullopt;
    return choose(values->condition, *above, *below);
  }
  const FormulaPart part = parts_[static_cast<std::size_t>(index)];
  if (part.kind == PartKind::voltage && levels_) {
    const std::optional<Levels> levels = levels_(part.index);
    return levels ? of_value(constant_sum(levels->low)) : std::nullopt;
  }
  if (part.kind != PartKind::choice) return std::nullopt;
  const std::optional<AffineSum> above = of_value(part.above), below = of_value(part.below);
  if (!above || !below) return std::nullopt;
  return hysteresis(part.argument, part.on_level, part.off_level, *above, *below);
}

std::optional<AffineSum> FormulaBuilder::reciprocal(const AffineSum& x) {
  if (x.is_constant()) {
    if (x.constant.value == 0.0) return std::nullopt;
    const Varied inverse = 1.0 / x.constant;
    return constant_sum(x.is_number() ? inverse : unfollowed_by(x, inverse));
  }
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

namespace {

/// a·b, a constant. What a parameter gives it as terms would be products of signals where b has some, too.
AffineSum scaled(const AffineSum& a, const AffineSum& b) {
  AffineSum product = a.constant * b;
  if (a.is_number()) return product;
  if (b.is_constant()) return product + b.constant * AffineSum{0.0, a.terms};
  product.constant = unfollowed_by(a, std::move(product.constant));
  return product;
}

}  // namespace

std::optional<AffineSum> FormulaBuilder::product(const AffineSum& a, const AffineSum& b) {
  if (a.is_constant()) return scaled(a, b);
  if (b.is_constant()) return scaled(b, a);
  if (auto product = product_of_time(a, b)) return product;
  if (auto product = switched_sum(a, b)) return product;
  return switched_sum(b, a);
}

}  // namespace pwlsim::elements
