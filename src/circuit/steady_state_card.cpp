#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/card_items.hpp"
#include "circuit/commands.hpp"
#include "circuit/measured_expression.hpp"
#include "netlist/number.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Item;
using ItemKind = Item::Kind;
using Trigger = SteadyStateAnalysis::Trigger;

constexpr std::string_view pss_usage =
    ".pss [period=T | freq=f] [k=N] [on=S1 | off=S1 | when v(a)=b [rise|fall]] [tstab=t] [points=N] [maxiter=N] [maxperiods=N] [tol=x] "
    "[uic]";
constexpr std::string_view when_usage =
    "after WHEN stands v(n), v(n,m) or i(X) = a number, or v(n) = v(m); for an expression try B1 x 0 V={...} and when v(x)=0";
constexpr double largest_count = 1e9;

/// .pss as pwlsim and as ngspice have it, and .pop.
class SteadyStateReader {
 public:
  SteadyStateReader(const Card& card, Scope& scope, Reporter& reporter, FlatCircuit& circuit)
      : card_(card), scope_(scope), reporter_(reporter), circuit_(circuit) {
    state_.span = card.span;
  }

  std::optional<SteadyStateAnalysis> read() {
    for (std::size_t k = 0; k < card_.items.size() && ok_; ++k) {
      const Item& item = card_.items[k];
      if (item.kind == ItemKind::assignment)
        take_assignment(item);
      else if (is_word(item, "uic"))
        state_.use_initial_conditions = true;
      else if (is_word(item, "free"))
        state_.is_free = true;
      else if (is_word(item, "when") && positional_ == 0)
        is_when_ = true;
      else if (is_word(item, "rise") || is_word(item, "fall") || is_word(item, "cross"))
        take_edge(item);
      else
        take_positional(item);
    }
    if (ok_ && is_when_ && state_.trigger != Trigger::crosses) fail("E-missing-value", card_.span, "WHEN names no signal and level");
    return ok_ ? std::optional(state_) : std::nullopt;
  }

 private:
  void fail(std::string id, SourceSpan span, std::string_view what) {
    reporter_.error(std::move(id), span, fmt::format("{}; usage: {}", what, pss_usage));
    ok_ = false;
  }

  std::optional<double> number(const Item& item) {
    const std::optional<Number> value = scope_.number(item);
    ok_ &= value.has_value();
    return value ? std::optional(value->value) : std::nullopt;
  }

  double positive(const Item& item, std::string_view name) {
    if (item.items.empty()) {
      fail("E-missing-value", item.span, fmt::format("a value is missing after {}=", name));
      return 1.0;
    }
    const double value = number(item.items[0]).value_or(1.0);
    if (!(value > 0.0 && std::isfinite(value))) fail("E-range", item.span, fmt::format("{} must be positive, not {}", name, value));
    return value;
  }

  int count(const Item& item, std::string_view name, std::string_view id) {
    if (item.items.empty()) {
      fail("E-missing-value", item.span, fmt::format("a value is missing after {}=", name));
      return 1;
    }
    const std::optional<double> given = number(item.items[0]);
    const double value = given.value_or(1.0);
    if (value < 1.0 || value > largest_count || value != std::floor(value))
      fail(std::string(id), item.span, fmt::format("{} must be 1, 2, ..., not {}", name, value));
    return ok_ ? static_cast<int>(value) : 1;
  }

  void take_assignment(const Item& item) {
    const auto is = [&](std::string_view name) { return same_name(item.text, name); };
    if (item.items.size() > 1) return take_crossing(item);
    if (is_when_ && (is("rise") || is("fall") || is("cross"))) return take_numbered_edge(item);
    if (is("period") || is("max_period")) {
      (is("period") ? state_.period : state_.longest_period) = positive(item, item.text);
    } else if (is("freq")) {
      state_.period = 1.0 / positive(item, "freq");
    } else if (is("k")) {
      state_.multiple = count(item, "k", "E-pss-bad-multiple");
    } else if (is("on") || is("trig_gate")) {
      take_trigger(item, Trigger::closes);
    } else if (is("off")) {
      take_trigger(item, Trigger::opens);
    } else if (is("trig_cond")) {
      state_.trigger = !item.items.empty() && item.items[0].text.starts_with("1") ? Trigger::opens : Trigger::closes;
    } else if (is("tstab")) {
      if (item.items.empty()) return fail("E-missing-value", item.span, "a value is missing after tstab=");
      const std::optional<double> value = number(item.items[0]);
      if (value && !(*value >= 0.0)) fail("E-range", item.span, "tstab must not be negative");
      state_.settling_time = value;
    } else if (is("points")) {
      state_.points = count(item, "points", "E-range");
    } else if (is("maxiter")) {
      state_.most_iterations = count(item, "maxiter", "E-range");
    } else if (is("maxperiods")) {
      state_.most_periods = count(item, item.text, "E-range");
    } else if (is("cycles_before_pop")) {
      state_.periods_before = count(item, item.text, "E-range");
    } else if (is("tol")) {
      state_.tolerance = positive(item, "tol");
    } else if (is_when_ && netlist::read_number(item.text).valid) {
      fail("E-unexpected", item.span, when_usage);
    } else if (!is("td_run_after_pop_fails")) {
      fail("E-unexpected", item.span,
           fmt::format("unknown parameter '{}'{}", item.text,
                       suggestion(item.text, {"period", "freq", "k", "on", "off", "tstab", "points", "maxiter", "maxperiods", "tol"})));
    }
  }

  void take_trigger(const Item& item, Trigger trigger) {
    if (item.items.empty()) return fail("E-missing-value", item.span, fmt::format("an element is missing after {}=", item.text));
    if (state_.trigger == Trigger::none) state_.trigger = trigger;
    state_.element = item.items[0].kind == ItemKind::expression ? reporter_.text(item.items[0].span) : item.items[0].text;
    state_.element_span = item.items[0].span;
  }

  void take_crossing(const Item& item) {
    if (!is_when_) return fail("E-unexpected", item.span, fmt::format("unexpected '{}'", reporter_.text(item.span)));
    if (!same_name(item.items[1].text, "v") && !same_name(item.items[1].text, "i")) return fail("E-unexpected", item.span, when_usage);
    std::optional<SaveRequest> signal = save_request(item.items[1], reporter_);
    ok_ &= signal.has_value() && signal->kind != SaveRequest::Kind::all;
    if (!ok_) return;
    const std::string text(reporter_.text(item.items[0].span));
    double level = 0.0;
    if (is_voltage(text) && is_plain_voltage(*signal)) {
      const std::optional<SaveRequest> other = save_request(item.items[0], reporter_);
      ok_ &= other.has_value();
      if (!ok_) return;
      if (!is_plain_voltage(*other))
        return fail("E-unexpected", item.items[0].span, "WHEN compares the voltages of two nodes, or a signal with a number");
      signal->second = other->first;
      signal->second_span = other->first_span;
      signal->column = fmt::format("v({},{})", signal->first, signal->second);
    } else {
      const std::optional<double> given = number(item.items[0]);
      if (!given) return;
      level = *given;
    }
    watch(std::move(*signal), level);
  }

  static bool is_voltage(const std::string& text) { return text.size() > 2 && same_name(text.substr(0, 2), "v("); }
  static bool is_plain_voltage(const SaveRequest& signal) { return signal.kind == SaveRequest::Kind::voltage && signal.second.empty(); }

  void watch(SaveRequest signal, double level) {
    state_.trigger = Trigger::crosses;
    state_.element = signal.column;
    state_.level = level;
    state_.probe = add_probe(circuit_, std::move(signal));
  }

  /// rise=1, as in .meas: every passage is one. Of passages in both directions (cross) the period begins with one that rises.
  void take_numbered_edge(const Item& item) {
    state_.is_falling = same_name(item.text, "fall");
    (void)count(item, item.text, "E-range");
  }

  void take_edge(const Item& item) {
    if (!is_when_) return fail("E-unexpected", item.span, fmt::format("{} is allowed only after WHEN", item.text));
    state_.is_falling = is_word(item, "fall");
  }

  /// ngspice: gfreq tstab oscnode psspoints harms [sciter steadycoeff]
  void take_positional(const Item& item) {
    if (is_when_) return fail("E-unexpected", item.span, when_usage);
    const int place = positional_++;
    if (place == 2) return take_node(item);
    if (place > 6) return fail("E-unexpected", item.span, fmt::format("unexpected '{}'", reporter_.text(item.span)));
    const std::optional<double> value = number(item);
    if (!value) return;
    if (!(*value >= 0.0)) return fail("E-range", item.span, fmt::format("a number of .pss must not be negative, not {}", *value));
    if (place == 0 && *value > 0.0) {
      state_.period = 1.0 / *value;
      state_.is_hint = true;
    }
    if (place == 1) state_.settling_time = *value;
    if (place == 3 && *value >= 1.0) state_.points = static_cast<int>(std::min(*value, largest_count));
  }

  /// The node that oscillates: the period begins where it rises through its mean.
  void take_node(const Item& item) {
    SaveRequest signal;
    std::string text(reporter_.text(item.span));
    if (is_voltage(text) && text.back() == ')') text = text.substr(2, text.size() - 3);
    signal.first = text;
    signal.first_span = item.span;
    signal.column = fmt::format("v({})", text);
    if (state_.trigger != Trigger::none) return;
    state_.level_is_mean = true;
    watch(std::move(signal), 0.0);
  }

  const Card& card_;
  Scope& scope_;
  Reporter& reporter_;
  FlatCircuit& circuit_;
  SteadyStateAnalysis state_;
  bool ok_ = true, is_when_ = false;
  int positional_ = 0;
};

/// "X1:S1" and "X1.S1" are one.
std::string with_dots(std::string name) {
  std::replace(name.begin(), name.end(), ':', '.');
  return name;
}

}  // namespace

void check_trigger(Reporter& reporter, FlatCircuit& circuit) {
  if (!circuit.analyses.steady_state) return;
  SteadyStateAnalysis& state = *circuit.analyses.steady_state;
  if (state.trigger != Trigger::closes && state.trigger != Trigger::opens) return;
  const std::string wanted = with_dots(state.element);
  std::vector<std::string> names;
  for (const elements::Instance& instance : circuit.instances) {
    const std::string name = with_dots(instance.name);
    if (same_name(name, wanted)) {
      state.element = instance.name;
      return;
    }
    // A part of what the element has become.
    if (name.size() > wanted.size() && name[wanted.size()] == '.' && same_name(name.substr(0, wanted.size()), wanted)) return;
    if (instance.kind != nullptr) names.push_back(instance.name);
  }
  reporter.error("E-unknown-element", state.element_span,
                 fmt::format("unknown element '{}'{}", state.element, suggestion(state.element, names)));
}

void read_steady_state(const Definitions& definitions, Scope& scope, Reporter& reporter, FlatCircuit& circuit) {
  const auto& cards = definitions.steady_states;
  for (std::size_t k = 0; k + 1 < cards.size(); ++k)
    reporter.warning("W-second-pss", cards[k]->name_span,
                     fmt::format("this {} is not run: the last one is used, at {}", cards[k]->name, reporter.where(cards.back()->span)));
  if (cards.empty() || cards.back()->damaged) return;
  circuit.analyses.steady_state = SteadyStateReader(*cards.back(), scope, reporter, circuit).read();
}

}  // namespace pwlsim::circuit
