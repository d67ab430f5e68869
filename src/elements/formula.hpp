#pragma once
/// Piecewise-linear functions of voltages, currents and time, in a form that maps one to one onto complementarity ports.
///
/// A value is an affine sum of parts. A part is a signal, a function of time, or a nonlinearity of an affine sum of earlier parts:
///
///     positive   max(x, 0)                                        one port
///     step       1 for x > 0, 0 for x < 0, any value between at 0 two ports
///     choice     one of two sums, chosen by a control with thresholds (a driven switch, no port)
///     integral, derivative, transfer   of an affine sum, in time: states; a control may hold an integral at a value,
///                and an integral that reaches the end of a range may continue at the other end
///     product, quotient, call   of sums whose signals may prove to be numbers or to take two values: without_products replaces them
///
/// max(a,b) = a + positive(b−a), abs(x) = 2·positive(x) − x, sgn(x) = 2·step(x) − 1; a table is a sum of its kinks. Parts are
/// normalised and shared: positive(x), positive(3x) and positive(−x) are one port.
///
/// Numbers carry their derivatives to the parameters of `.sens`; what they decide (a sign, a rank, what is shared) their values decide, and parts that move
/// differently are not shared. Where the value has a kink, or a derivative would be a product of signals, it is NaN.

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "base/source.hpp"
#include "elements/varied.hpp"
#include "model/source_function.hpp"

namespace pwlsim::elements {

/// constant + Σ coefficient·part, ascending in the part; a coefficient is zero only where a parameter moves it.
struct AffineSum {
  Varied constant;
  std::vector<std::pair<int, Varied>> terms;

  /// Whatever its parts do. A parameter may give it terms.
  [[nodiscard]] bool is_constant() const {
    return std::all_of(terms.begin(), terms.end(), [](const auto& term) { return term.second.value == 0.0; });
  }
  [[nodiscard]] bool is_number() const { return terms.empty(); }
  [[nodiscard]] bool moves() const {
    return constant.moves() || std::any_of(terms.begin(), terms.end(), [](const auto& term) { return term.second.moves(); });
  }
  bool operator==(const AffineSum&) const = default;
};

[[nodiscard]] AffineSum constant_sum(Varied value);
[[nodiscard]] AffineSum operator+(const AffineSum& a, const AffineSum& b);
[[nodiscard]] AffineSum operator-(const AffineSum& a, const AffineSum& b);
[[nodiscard]] AffineSum operator*(const Varied& factor, const AffineSum& a);

/// A proper rational function of s, the highest power first; the denominator's first coefficient is not zero.
struct RationalFunction {
  std::vector<Varied> num{0.0}, den{1.0};
  bool operator==(const RationalFunction&) const = default;
};

/// A function without a piecewise-linear form, except for numbers and, in some cases, for functions of time.
struct SmoothFunction {
  enum class Form { other, sine, cosine, exponential, arc_sine, arc_cosine };
  std::string_view name{};
  double (*value)(std::span<const double> arguments) = nullptr;
  std::size_t count = 1;  ///< of arguments, at most two
  Form form = Form::other;
  bool operator==(const SmoothFunction&) const = default;
};

struct FormulaPart {
  enum class Kind { voltage, current, time, positive, step, choice, integral, derivative, transfer, product, quotient, call };
  Kind kind = Kind::voltage;
  int index = 0;                     ///< voltage: of Instance::control_nodes; current: of Instance::references
  model::SourceFunction function{};  ///< time
  std::vector<std::optional<model::SourceFunction>>
      function_moves{};  ///< time: derivatives of the function's numbers to each parameter that moves them
  AffineSum argument{};  ///< the argument of a nonlinearity or a part with states; the control of a choice
  AffineSum above{},
      below{};  ///< choice: its value above on_level until the control falls below off_level, and else; the factors of a product, of a quotient its two terms, the arguments of a call
  Varied on_level{}, off_level{};
  double at_zero = 0.5;         ///< step outside of loops: its value while the argument stays at 0
  Varied start{};               ///< integral: its value at the start, and while it is held
  bool is_held = false;         ///< integral: it stays at `start` while `above` is above on_level
  double from = 0.0, to = 0.0;  ///< integral: its range, none if they are equal
  RationalFunction fraction{};  ///< transfer
  SmoothFunction called{};      ///< call

  bool operator==(const FormulaPart&) const = default;
};

/// The formula of an element. A part refers only to earlier parts.
struct Formula {
  std::vector<FormulaPart> parts;
  AffineSum value;
  std::vector<std::pair<int, SourceSpan>> open_products;  ///< parts of kind product, quotient or call, and their spans
};

/// The values of a voltage: one of the two at any time, or a constant if both are equal.
struct Levels {
  double low = 0.0, high = 0.0;
};
/// For a pair of control nodes; empty if the voltage takes other values, too.
using LevelsOf = std::function<std::optional<Levels>(int control_pair)>;
/// For a pair of control nodes; empty if the voltage is not constant.
using ConstantOf = std::function<std::optional<double>(int control_pair)>;

struct TablePoint {
  Varied x, y;
};

/// A truth value: 1 or 0, set-valued if the sides of a comparison are equal.
struct Condition {
  AffineSum value;
  std::optional<AffineSum> margin;  ///< of a single comparison: true if the margin is positive

  [[nodiscard]] bool is_constant() const { return value.is_constant(); }
  [[nodiscard]] bool holds() const { return value.constant.value > 0.5; }
};

class FormulaBuilder {
 public:
  FormulaBuilder() = default;
  FormulaBuilder(LevelsOf levels, ConstantOf constant) : levels_(std::move(levels)), constant_(std::move(constant)) {}

  [[nodiscard]] AffineSum voltage(int control_pair) { return part({.kind = FormulaPart::Kind::voltage, .index = control_pair}); }
  [[nodiscard]] AffineSum current(int reference) { return part({.kind = FormulaPart::Kind::current, .index = reference}); }

  [[nodiscard]] AffineSum positive(const AffineSum& x);
  [[nodiscard]] AffineSum step(const AffineSum& x, double at_zero = 0.0);
  [[nodiscard]] AffineSum maximum(const AffineSum& a, const AffineSum& b);
  [[nodiscard]] AffineSum minimum(const AffineSum& a, const AffineSum& b);
  [[nodiscard]] AffineSum absolute(const AffineSum& x) { return 2.0 * positive(x) - x; }
  [[nodiscard]] AffineSum sign(const AffineSum& x) { return 2.0 * step(x, 0.5) - constant_sum(1.0); }
  /// x limited by two bounds, in either order: their median.
  [[nodiscard]] AffineSum limit(const AffineSum& x, const AffineSum& a, const AffineSum& b);
  /// Straight lines between the points, whose x must not decrease; equal ones are a jump. Beyond the ends constant, or extrapolated.
  [[nodiscard]] AffineSum table(const AffineSum& x, const std::vector<TablePoint>& points, bool extrapolated);

  [[nodiscard]] Condition greater(const AffineSum& a, const AffineSum& b, bool or_equal = false);
  [[nodiscard]] Condition both(const Condition& a, const Condition& b);
  [[nodiscard]] Condition either(const Condition& a, const Condition& b);
  [[nodiscard]] static Condition negation(const Condition& a);
  [[nodiscard]] AffineSum choose(const Condition& condition, const AffineSum& yes, const AffineSum& no);
  /// `above` after the control has risen above on_level until it falls below off_level ≤ on_level, else `below`.
  [[nodiscard]] AffineSum hysteresis(const AffineSum& control, const Varied& on_level, const Varied& off_level, const AffineSum& above,
                                     const AffineSum& below);

  /// In time. Some need no state: the derivative of a number, the derivative of an integral, a fraction without s.
  [[nodiscard]] AffineSum integral(const AffineSum& x, const Varied& start);
  /// Stays at `start` while `held` is true.
  [[nodiscard]] AffineSum integral(const AffineSum& x, const Varied& start, const Condition& held);
  /// Shifted into the range by whole multiples of its width.
  [[nodiscard]] std::optional<AffineSum> wrapped_integral(const AffineSum& x, const Varied& start, const Varied& from, const Varied& to);
  /// For max(x, 0): that of x while x is positive. Empty if a comparison or a choice may jump, because a value cannot contain impulses.
  [[nodiscard]] std::optional<AffineSum> derivative(const AffineSum& x);
  [[nodiscard]] AffineSum transfer(const AffineSum& x, const RationalFunction& fraction);

  [[nodiscard]] AffineSum time();
  /// Whether it is a function of time only: a sum of constants, exponentials, sinusoids and a linear function.
  [[nodiscard]] bool is_of_time(const AffineSum& x) const;
  /// floor(x) of a linear function of time: x minus a sawtooth. Empty otherwise.
  [[nodiscard]] std::optional<AffineSum> floor(const AffineSum& x);
  /// Whether x is a linear function of time that is never negative.
  [[nodiscard]] bool rises_from_zero(const AffineSum& x) const;
  /// Of two sums of which one is constant, both are of time, or one is a sum of parts that take two values each (comparisons, choices between numbers, voltages
  /// of two levels): switched forms of the other. Empty where the product leaves that class.
  [[nodiscard]] std::optional<AffineSum> product(const AffineSum& a, const AffineSum& b);
  /// For two sums without a form by product(), until the levels of voltages are known.
  [[nodiscard]] AffineSum open_product(const AffineSum& a, const AffineSum& b);
  [[nodiscard]] AffineSum open_quotient(const AffineSum& a, const AffineSum& b);
  /// For sums without a form by call(), until voltages are known.
  [[nodiscard]] AffineSum open_call(const SmoothFunction& called, const AffineSum& a, const AffineSum& b);
  /// For numbers, and if the result is a function of time; empty otherwise, and if a number is not finite.
  [[nodiscard]] std::optional<AffineSum> call(const SmoothFunction& called, const AffineSum& a, const AffineSum& b);
  using Translation = std::function<AffineSum(const AffineSum&)>;
  [[nodiscard]] std::optional<AffineSum> same_part(const FormulaPart& part, const Translation& now);
  /// 1/x of a sum of few parts that take two values each: a choice of reciprocals. Empty otherwise, and if a value is zero.
  [[nodiscard]] std::optional<AffineSum> reciprocal(const AffineSum& x);
  /// sin(x + phase) and exp(x), x a linear function of time. Empty otherwise.
  [[nodiscard]] std::optional<AffineSum> sine(const AffineSum& x, const Varied& phase);
  [[nodiscard]] std::optional<AffineSum> exponential(const AffineSum& x);
  /// asin(x), x a sinusoid in time of amplitude 1: a triangle. Empty otherwise.
  [[nodiscard]] std::optional<AffineSum> arc_sine(const AffineSum& x);

  [[nodiscard]] Formula finish(AffineSum value) && { return {std::move(parts_), std::move(value), {}}; }
  [[nodiscard]] const std::vector<FormulaPart>& parts() const { return parts_; }

 private:
  [[nodiscard]] AffineSum part(FormulaPart part);
  /// `move`: the derivatives of its numbers to a parameter.
  [[nodiscard]] AffineSum function_of_time(model::SourceFunction function, std::size_t parameters = 0,
                                           const std::function<model::SourceFunction(std::size_t)>& move = {});
  /// Corners in time and value, from `repeat_from` on for ever if that is given.
  [[nodiscard]] AffineSum lines_of_time(const std::vector<TablePoint>& points, const std::optional<Varied>& repeat_from = std::nullopt);
  [[nodiscard]] AffineSum held_integral(const AffineSum& x, const Varied& start, const AffineSum& control, const Varied& level);
  [[nodiscard]] AffineSum oscillation(const Varied& amplitude, Varied omega, const Varied& damping, Varied phase);
  /// e^{−damping·t}·sin(2π·frequency·t + phase)
  [[nodiscard]] AffineSum damped(const Varied& amplitude, const Varied& frequency, const Varied& damping, const Varied& phase);
  [[nodiscard]] std::optional<AffineSum> product_of_parts(int a, int b);
  [[nodiscard]] std::optional<AffineSum> product_of_time(const AffineSum& a, const AffineSum& b);
  using Values = std::function<std::optional<AffineSum>(const AffineSum&)>;
  /// For a part that takes two values, or is a choice: each value replaced by `of_value` of it.
  [[nodiscard]] std::optional<AffineSum> switched(int part, const Values& of_value);
  /// Where a part steps from one value to another: in time, with the sign of its argument, or because a voltage does. Then the part is below + (above − below)·condition.
  struct TwoValued {
    Condition condition;
    Varied below, above;
  };
  [[nodiscard]] std::optional<TwoValued> two_valued(int part);
  /// A corner of a PWL in time.
  [[nodiscard]] static TablePoint corner_of(const FormulaPart& part, std::size_t number);
  [[nodiscard]] std::optional<AffineSum> switched_sum(const AffineSum& a, const AffineSum& x);
  /// c and t0 if x = c·(t − t0), c ≠ 0.
  struct Line {
    Varied slope, zero;
  };
  [[nodiscard]] std::optional<Line> line_in_time(const AffineSum& x) const;
  [[nodiscard]] AffineSum table_of_time(const Line& line, const std::vector<TablePoint>& points, bool extrapolated);

  std::vector<FormulaPart> parts_;
  LevelsOf levels_;
  ConstantOf constant_;
};

/// The formula with switched forms in place of its products. Empty if part number `failed` has none.
[[nodiscard]] std::optional<Formula> without_products(const Formula& formula, const LevelsOf& levels, const ConstantOf& constant,
                                                      int& failed);

}  // namespace pwlsim::elements
