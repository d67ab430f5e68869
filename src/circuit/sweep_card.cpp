#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/decimal.hpp"
#include "base/names.hpp"
#include "circuit/card_items.hpp"
#include "circuit/commands.hpp"
#include "circuit/models.hpp"
#include "elements/catalogue.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Item;
using ItemKind = Item::Kind;

constexpr std::string_view step_usage =
    ".step param name start stop step | list a b … | dec|oct start stop points; .step TYPE model(parameter) start stop step";
/// First letters of elements whose value can be stepped.
constexpr std::string_view stepped_elements = "virlc";
constexpr std::size_t most_sweeps = 3;
constexpr double most_points = 1e6;

enum class Spacing { linear, decade, octave, list };

std::optional<Spacing> spacing_of(const Item& item) {
  if (is_word(item, "lin")) return Spacing::linear;
  if (is_word(item, "dec")) return Spacing::decade;
  if (is_word(item, "oct")) return Spacing::octave;
  if (is_word(item, "list")) return Spacing::list;
  return std::nullopt;
}

Decimal decimal_of(const Number& number) {
  const auto written = parse_decimal(number.decimal);
  return written ? *written : decimal_from_double(number.value);
}

bool steps_temperature(const Card& card) {
  const std::size_t at = !card.items.empty() && spacing_of(card.items[0]) ? 1 : 0;
  return at < card.items.size() && is_word(card.items[at], "temp");
}

class SweepReader {
 public:
  SweepReader(const Card& card, Scope& scope, Reporter& reporter) : card_(card), scope_(scope), reporter_(reporter) {}

  std::optional<Sweep> read() {
    std::size_t at = 0;
    const auto& items = card_.items;
    const auto take_spacing = [&] {
      if (at >= items.size()) return;
      if (const auto spacing = spacing_of(items[at])) {
        spacing_ = *spacing;
        ++at;
      }
    };
    take_spacing();
    if (at < items.size() && is_word(items[at], "param")) {
      ++at;
      sweep_.is_parameter = true;
    }
    if (at >= items.size()) return fail("E-missing-value", card_.span, "it does not say what to step");
    if (!sweep_.is_parameter && at + 1 < items.size() && names_model(items[at], items[at + 1])) {
      if (!take_model(items[at], items[at + 1])) return std::nullopt;
      return read_values(at + 2);
    }
    const Item& name = items[at++];
    if (!accepts(name, at < items.size() ? &items[at] : nullptr)) return std::nullopt;
    sweep_.name = name.text;
    sweep_.span = name.span;
    return read_values(at);
  }

  /// What could be read where there was an error: of a parameter, the name.
  [[nodiscard]] const Sweep& so_far() const { return sweep_; }

 private:
  std::optional<Sweep> read_values(std::size_t at) {
    const auto& items = card_.items;
    if (at < items.size()) {
      if (const auto spacing = spacing_of(items[at])) {
        spacing_ = *spacing;
        ++at;
      }
    }
    std::vector<Number> numbers;
    for (; at < items.size(); ++at) {
      if (items[at].kind == ItemKind::assignment && same_name(items[at].text, "file"))
        return fail("E-not-supported", items[at].span, "file= is not supported");
      const std::optional<Number> number = scope_.number(items[at]);
      if (!number) return std::nullopt;
      numbers.push_back(*number);
    }
    if (!spread(numbers)) return std::nullopt;
    return sweep_;
  }

  /// `NPN QX(BF)`
  static bool names_model(const Item& type, const Item& model) {
    return type.kind == ItemKind::word && elements::find_model_kind(type.text) != nullptr && model.kind == ItemKind::group &&
           model.items.size() == 1 && model.items[0].kind == ItemKind::word;
  }

  /// None where the card does not say it (`ako:`).
  const elements::ModelKind* kind_of(const netlist::Card& card) const {
    const std::optional<ModelText> text = read_model_text(card, reporter_);
    return text && !text->type.empty() ? elements::find_model_kind(text->type) : nullptr;
  }

  /// A parameter of the deck that no expression can name, for Models to find.
  bool take_model(const Item& type, const Item& model) {
    const Item& name = model.items[0];
    const elements::Parameter* parameter = elements::find_parameter(elements::find_model_kind(type.text)->parameters, name.text);
    const auto found = scope_.definition().models.find(without_case(model.text));
    const elements::ModelKind* kind = found == scope_.definition().models.end() ? nullptr : kind_of(*found->second);
    if (found == scope_.definition().models.end()) {
      (void)fail("E-unknown-model", model.span, fmt::format("unknown model '{}'", model.text));
    } else if (kind != nullptr && kind != elements::find_model_kind(type.text)) {
      (void)fail("E-wrong-model-type", type.span, fmt::format("the model {} is of type {}, not {}", model.text, kind->type, type.text));
    } else if (parameter == nullptr || parameter->use != elements::Use::honoured) {
      (void)fail("E-unknown-parameter", name.span, fmt::format("{} has no effect in a model of type {}", name.text, type.text));
    } else {
      sweep_.is_parameter = true;
      sweep_.name = stepped_model_name(model.text, parameter->name);
      sweep_.span = model.span;
      return true;
    }
    return false;
  }

  std::nullopt_t fail(std::string id, SourceSpan span, std::string_view text) {
    reporter_.error(std::move(id), span, fmt::format(".step: {}; usage: {}", text, step_usage));
    return std::nullopt;
  }

  bool accepts(const Item& name, const Item* next) {
    if (sweep_.is_parameter && name.kind == ItemKind::word) return true;
    const bool is_element = name.kind == ItemKind::word && stepped_elements.find(lower_letter(name.text.front())) != std::string_view::npos;
    if (is_element && (next == nullptr || next->kind != ItemKind::group)) return true;
    (void)fail("E-not-supported", name.span,
               fmt::format("{} is neither a parameter nor a source, resistor, capacitor or inductor, nor the type of a model with its "
                           "parameter; try .step param x … and {{x}} as the value of "
                           "the element, or in its model",
                           reporter_.text(name.span)));
    return false;
  }

  bool spread(const std::vector<Number>& numbers) {
    if (spacing_ == Spacing::list) {
      if (numbers.empty()) (void)fail("E-missing-value", card_.span, "the list is empty");
      for (const Number& number : numbers) sweep_.values.push_back(number.value);
      return !numbers.empty();
    }
    if (numbers.size() != 3) {
      (void)fail(numbers.size() < 3 ? "E-missing-value" : "E-unexpected", card_.span, "it takes three numbers");
      return false;
    }
    return spacing_ == Spacing::linear ? spread_evenly(numbers) : spread_by_ratio(numbers[0].value, numbers[1].value, numbers[2].value);
  }

  bool too_many(double count) {
    if (count <= most_points) return false;
    reporter_.error("E-too-many-runs", card_.span,
                    fmt::format("{:.6g} values of {}, more than {}; try a larger step", count, sweep_.name, most_points));
    return true;
  }

  /// From the decimal text, as the rows of .tran. The stop belongs to it where rounding alone keeps it from being a step.
  bool spread_evenly(const std::vector<Number>& numbers) {
    constexpr double rounding = 1e-9;
    const double stop = numbers[1].value, span = stop - numbers[0].value;
    const double size = std::copysign(numbers[2].value, span);
    if (size == 0.0 && span != 0.0) {
      (void)fail("E-range", card_.span, "the step must not be 0");
      return false;
    }
    const double count = span == 0.0 ? 0.0 : std::floor(span / size * (1.0 + rounding) + rounding);
    if (too_many(count)) return false;
    const Decimal start = decimal_of(numbers[0]);
    Decimal step = decimal_of(numbers[2]);
    step.mantissa = std::signbit(size) ? -std::abs(step.mantissa) : std::abs(step.mantissa);
    for (std::int64_t k = 0; k <= static_cast<std::int64_t>(count); ++k) sweep_.values.push_back(affine(start, k, step));
    if (std::abs(sweep_.values.back() - stop) <= rounding * std::abs(size)) sweep_.values.back() = stop;
    return true;
  }

  bool spread_by_ratio(double start, double stop, double points) {
    constexpr double rounding = 1e-9;
    const double base = spacing_ == Spacing::decade ? 10.0 : 2.0;
    const bool possible = start * stop > 0.0 && points >= 1.0 && points == std::floor(points);
    if (!possible) {
      (void)fail("E-range", card_.span,
                 "start and stop must have the same sign, and the points per decade or octave must be a whole number");
      return false;
    }
    const double direction = std::abs(stop) >= std::abs(start) ? 1.0 : -1.0;
    const double count = std::floor(std::abs(std::log(stop / start) / std::log(base)) * points + rounding);
    if (too_many(count)) return false;
    for (double k = 0.0; k <= count; ++k) sweep_.values.push_back(start * std::pow(base, direction * k / points));
    if (std::abs(sweep_.values.back() - stop) <= rounding * std::abs(stop)) sweep_.values.back() = stop;
    return true;
  }

  const Card& card_;
  Scope& scope_;
  Reporter& reporter_;
  Sweep sweep_;
  Spacing spacing_ = Spacing::linear;
};

/// The value of a resistor, capacitor or inductor; false where it has none.
bool set_value(elements::Instance& instance, double value, SourceSpan span) {
  const elements::Values& given = instance.values;
  const std::string name(1, lower_letter(instance.kind->letter));
  if (instance.formula || elements::find_parameter(given.table(), name) == nullptr) return false;
  std::erase_if(instance.written, [&](const elements::Written& written) { return written.span == given.span(name); });
  instance.values.set(name, value, span);
  return true;
}

}  // namespace

std::string stepped_model_name(std::string_view model, std::string_view parameter) { return fmt::format("{}({})", model, parameter); }

bool Sweep::is_source() const { return !is_parameter && std::string_view("vi").find(lower_letter(name.front())) != std::string_view::npos; }

std::size_t Sweeps::runs() const {
  std::size_t count = list.empty() ? 0 : 1;
  for (const Sweep& sweep : list) count *= sweep.values.size();
  return count;
}

std::vector<double> Sweeps::point(std::size_t run) const {
  std::vector<double> values;
  for (const Sweep& sweep : list) {
    values.push_back(sweep.values[run % sweep.values.size()]);
    run /= sweep.values.size();
  }
  return values;
}

void read_sweeps(const Definitions& definitions, Scope& scope, Reporter& reporter, Sweeps& sweeps) {
  for (const Card* card : definitions.sweeps) {
    if (card->damaged) continue;
    if (steps_temperature(*card)) {
      reporter.note(
          "N-step-temperature", card->span,
          "the elements are ideal and have no temperature: .step temp is one run; try .step param temp … and {temp} in the values "
          "that depend on it");
      continue;
    }
    SweepReader reader(*card, scope, reporter);
    std::optional<Sweep> sweep = reader.read();
    if (!sweep) {
      if (reader.so_far().is_parameter && !reader.so_far().name.empty()) scope.define_failed(reader.so_far().name, reader.so_far().span);
      continue;
    }
    const auto same = [&](const Sweep& other) { return same_name(other.name, sweep->name); };
    if (std::any_of(sweeps.list.begin(), sweeps.list.end(), same))
      reporter.error("E-duplicate-parameter", sweep->span, fmt::format("{} is stepped twice", sweep->name));
    else
      sweeps.list.push_back(std::move(*sweep));
  }
  if (sweeps.list.size() > most_sweeps)
    reporter.error("E-unexpected", sweeps.list[most_sweeps].span, fmt::format("more than {} .step cards", most_sweeps));
  double runs = 1.0;
  for (const Sweep& sweep : sweeps.list) runs *= static_cast<double>(sweep.values.size());
  if (runs > most_points)
    reporter.error("E-too-many-runs", sweeps.list.back().span,
                   fmt::format("the .step cards ask for {:.6g} runs, more than {}", runs, most_points));
}

void give_stepped_parameters(const Sweeps& sweeps, std::size_t run, Scope& scope) {
  const std::vector<double> values = sweeps.point(run);
  for (std::size_t k = 0; k < values.size(); ++k)
    if (sweeps.list[k].is_parameter) scope.define(sweeps.list[k].name, values[k], sweeps.list[k].span);
}

void set_stepped_elements(const Sweeps& sweeps, std::size_t run, Reporter& reporter, FlatCircuit& circuit) {
  const std::vector<double> values = sweeps.point(run);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const Sweep& sweep = sweeps.list[k];
    if (sweep.is_parameter) continue;
    const auto found = std::find_if(circuit.instances.begin(), circuit.instances.end(),
                                    [&](const elements::Instance& instance) { return same_name(instance.name, sweep.name); });
    if (found == circuit.instances.end()) {
      reporter.error("E-unknown-element", sweep.span, fmt::format("unknown element '{}'", sweep.name));
    } else if (found->waveform && std::holds_alternative<model::Dc>(*found->waveform)) {
      found->waveform = model::Dc{values[k]};
    } else if (!sweep.is_source() && set_value(*found, values[k], sweep.span)) {
      continue;
    } else {
      reporter.error("E-not-supported", sweep.span,
                     fmt::format(".step: {} follows {} and has no single value to step; try a parameter in it", sweep.name,
                                 sweep.is_source() ? "a waveform" : "an expression"));
    }
  }
}

}  // namespace pwlsim::circuit
