#include "circuit/xspice_oscillators.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/names.hpp"
#include "circuit/definitions.hpp"
#include "circuit/made_expressions.hpp"
#include "netlist/number.hpp"

namespace pwlsim::circuit {
namespace {

using make::call;
using make::number;
using make::operation;
using netlist::Card;
using netlist::Expression;
using netlist::Item;
using ItemKind = Item::Kind;

constexpr std::string_view oscillators[] = {"triangle", "square", "sine", "d_osc", "d_pwm"};

Item with_items(ItemKind kind, std::string_view text, std::vector<Item> items, SourceSpan span) {
  Item item;
  item.kind = kind;
  item.text = text;
  item.span = item.text_span = span;
  item.items = std::move(items);
  return item;
}

class Oscillator {
 public:
  Oscillator(const Card& card, std::string_view type, std::span<const Item> control, const GivenParameter& given)
      : type_(type), control_(control), given_(given), span_(card.items.back().span) {}

  /// V PULSE(…) or B V={…}, without its nodes.
  [[nodiscard]] std::pair<char, Item> source() const {
    if (same_name(type_, "triangle") && fixed_frequency()) return {'V', pulse()};
    return {'B', with_items(ItemKind::assignment, "V", {make::item(value(), span_)}, span_)};
  }

 private:
  [[nodiscard]] Expression given(std::string_view name, double otherwise) const {
    const Item* item = given_(name);
    return item != nullptr ? make::value(*item) : number(otherwise);
  }

  [[nodiscard]] std::vector<Item> list(std::string_view name) const {
    const Item* item = given_(name);
    if (item == nullptr) return {};
    return item->items.empty() ? std::vector<Item>{*item} : item->items;
  }

  [[nodiscard]] static bool are_equal(const Item& a, const Item& b) {
    const Expression x = make::value(a), y = make::value(b);
    if (x.kind == Expression::Kind::number && y.kind == x.kind) return x.number == y.number;
    return x.kind == Expression::Kind::name && y.kind == x.kind && same_name(x.text, y.text);
  }

  /// That of d_pwm, or the one that all points of the control give.
  [[nodiscard]] std::optional<Expression> fixed_frequency() const {
    if (same_name(type_, "d_pwm")) return given("frequency", 1.0);
    const std::vector<Item> frequencies = list("freq_array");
    if (frequencies.empty()) return number(1.0);
    const bool is_one =
        std::all_of(frequencies.begin(), frequencies.end(), [&](const Item& item) { return are_equal(item, frequencies[0]); });
    return is_one ? std::optional(make::value(frequencies[0])) : std::nullopt;
  }

  [[nodiscard]] Expression control() const {
    std::vector<Expression> nodes;
    for (const Item& node : control_) nodes.push_back(make::name(node.text, node.span));
    return call("v", std::move(nodes));
  }

  /// Straight lines between points, which go on beyond the last ones.
  [[nodiscard]] Expression controlled(std::string_view values) const {
    const std::vector<Item> at = list("cntl_array"), to = list(values);
    std::vector<Expression> arguments{control()};
    for (std::size_t k = 0; k < std::min(at.size(), to.size()); ++k) {
      arguments.push_back(make::value(at[k]));
      arguments.push_back(make::value(to[k]));
    }
    return call("pwl", std::move(arguments));
  }

  [[nodiscard]] Expression start() const { return operation(given("init_phase", 0.0), "/", number(360.0)); }

  [[nodiscard]] Expression turns(const Expression& frequency) const {
    return operation(operation(frequency, "*", make::name("time")), "+", start());
  }

  [[nodiscard]] Expression phase() const {
    if (const auto frequency = fixed_frequency()) return call("mod", {turns(*frequency), number(1.0)});
    return call("idtmod", {controlled("freq_array"), start(), number(1.0)});
  }

  [[nodiscard]] Expression duty() const { return same_name(type_, "d_pwm") ? controlled("dc_array") : given("duty_cycle", 0.5); }

  [[nodiscard]] Expression value() const {
    const bool is_bit = type_.starts_with('d');
    const Expression low = is_bit ? number(0.0) : given("out_low", -1.0), high = is_bit ? number(1.0) : given("out_high", 1.0);
    const Expression swing = operation(high, "-", low);
    if (same_name(type_, "sine")) return operation(operation(number(0.5), "*", operation(high, "+", low)), "+", oscillation(swing));
    if (!same_name(type_, "triangle")) return call("if", {operation(phase(), ">=", operation(number(1.0), "-", duty())), high, low});
    const Expression up = operation(phase(), "/", duty());
    const Expression down = operation(operation(number(1.0), "-", phase()), "/", operation(number(1.0), "-", duty()));
    return operation(low, "+", operation(swing, "*", call("min", {up, down})));
  }

  /// Of a frequency that changes it has no piecewise-linear form, which is an error where the expression is read.
  [[nodiscard]] Expression oscillation(const Expression& swing) const {
    const auto frequency = fixed_frequency();
    const Expression angle = operation(operation(number(2.0), "*", make::name("pi")), "*", frequency ? turns(*frequency) : phase());
    return operation(operation(number(0.5), "*", swing), "*", call("sin", {angle}));
  }

  [[nodiscard]] Item pulse() const {
    const Expression frequency = *fixed_frequency();
    std::vector<Item> items;
    for (const Expression& each :
         {given("out_low", -1.0), given("out_high", 1.0), number(0.0), operation(duty(), "/", frequency),
          operation(operation(number(1.0), "-", duty()), "/", frequency), number(0.0), operation(number(1.0), "/", frequency)})
      items.push_back(make::item(each, span_));
    return with_items(ItemKind::group, "PULSE", std::move(items), span_);
  }

  std::string_view type_;
  std::span<const Item> control_;
  const GivenParameter& given_;
  SourceSpan span_;
};

}  // namespace

bool is_oscillator(std::string_view type) { return is_one_of(oscillators, type); }

Card oscillator_card(const Card& card, std::string_view type, std::span<const Item> control, std::span<const Item> output,
                     const GivenParameter& given) {
  auto [letter, value] = Oscillator(card, type, control, given).source();
  Card made = card;
  made.name = std::string(1, letter) + "~" + card.name;
  made.items.assign(output.begin(), output.end());
  if (output.size() == 1) made.items.push_back(made_word("0", card.items.back().span));
  made.items.push_back(std::move(value));
  return made;
}

}  // namespace pwlsim::circuit
