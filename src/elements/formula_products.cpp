/// Products, quotients and functions of signals that are numbers or take two values only: that is known when all elements are there.
#include <array>
#include <cmath>
#include <numbers>

#include "elements/formula.hpp"

namespace pwlsim::elements {
namespace {

using PartKind = FormulaPart::Kind;

}  // namespace

AffineSum FormulaBuilder::open_product(const AffineSum& a, const AffineSum& b) {
  return part({.kind = PartKind::product, .above = a, .below = b});
}

AffineSum FormulaBuilder::open_call(const SmoothFunction& called, const AffineSum& a, const AffineSum& b) {
  return part({.kind = PartKind::call, .above = a, .below = b, .called = called});
}

std::optional<AffineSum> FormulaBuilder::call(const SmoothFunction& called, const AffineSum& a, const AffineSum& b) {
  using Form = SmoothFunction::Form;
  if (a.is_constant() && b.is_constant()) {
    // Numbers that the circuit holds; those of the deck have been folded with their derivatives.
    const std::array<double, 2> numbers{a.constant.value, b.constant.value};
    Varied value = called.value(std::span(numbers).first(called.count));
    if (!std::isfinite(value.value)) return std::nullopt;
    for (const AffineSum* argument : {&a, &b}) {
      value = unfollowed(value, argument->constant);
      for (const auto& term : argument->terms) value = unfollowed(value, term.second);
    }
    return constant_sum(value);
  }
  constexpr double quarter_turn = 0.5 * std::numbers::pi;
  switch (called.form) {
    case Form::sine:
      return sine(a, 0.0);
    case Form::cosine:
      return sine(a, quarter_turn);
    case Form::exponential:
      return exponential(a);
    case Form::arc_sine:
      return arc_sine(a);
    case Form::arc_cosine: {
      const std::optional<AffineSum> complement = arc_sine(a);
      return complement ? std::optional(constant_sum(quarter_turn) - *complement) : std::nullopt;
    }
    case Form::other:
      break;
  }
  return std::nullopt;
}

AffineSum FormulaBuilder::open_quotient(const AffineSum& a, const AffineSum& b) {
  return part({.kind = PartKind::quotient, .above = a, .below = b});
}

/// The same part of this builder, whose arguments `now` gives.
std::optional<AffineSum> FormulaBuilder::same_part(const FormulaPart& part, const Translation& now) {
  switch (part.kind) {
    case PartKind::voltage:
      if (const std::optional<double> constant = constant_ ? constant_(part.index) : std::nullopt) return constant_sum(*constant);
      return this->part(part);
    case PartKind::current:
    case PartKind::time:
      return this->part(part);
    case PartKind::positive:
      return positive(now(part.argument));
    case PartKind::step:
      return step(now(part.argument), part.at_zero);
    case PartKind::choice:
      return hysteresis(now(part.argument), part.on_level, part.off_level, now(part.above), now(part.below));
    case PartKind::integral:
      if (part.is_held) return held_integral(now(part.argument), part.start, now(part.above), part.on_level);
      if (part.from != part.to) return wrapped_integral(now(part.argument), part.start, part.from, part.to);
      return integral(now(part.argument), part.start);
    case PartKind::derivative:
      return derivative(now(part.argument));
    case PartKind::transfer:
      return transfer(now(part.argument), part.fraction);
    case PartKind::product:
      return product(now(part.above), now(part.below));
    case PartKind::quotient: {
      const std::optional<AffineSum> inverse = reciprocal(now(part.below));
      return inverse ? product(now(part.above), *inverse) : std::nullopt;
    }
    case PartKind::call:
      return call(part.called, now(part.above), now(part.below));
  }
  return std::nullopt;
}

std::optional<Formula> without_products(const Formula& formula, const LevelsOf& levels, const ConstantOf& constant, int& failed) {
  FormulaBuilder builder(levels, constant);
  std::vector<AffineSum> sums;
  const auto now = [&](const AffineSum& old) {
    AffineSum sum = constant_sum(old.constant);
    for (const auto& [part, coefficient] : old.terms) sum = sum + coefficient * sums[static_cast<std::size_t>(part)];
    return sum;
  };
  for (const FormulaPart& part : formula.parts) {
    std::optional<AffineSum> sum = builder.same_part(part, now);
    if (!sum) {
      failed = static_cast<int>(sums.size());
      return std::nullopt;
    }
    sums.push_back(std::move(*sum));
  }
  AffineSum value = now(formula.value);
  return std::move(builder).finish(std::move(value));
}

}  // namespace pwlsim::elements
