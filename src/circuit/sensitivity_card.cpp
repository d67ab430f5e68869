#include <algorithm>

#include <fmt/format.h>

#include "circuit/card_items.hpp"
#include "circuit/commands.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Item;
using ItemKind = Item::Kind;

constexpr std::string_view sens_usage = ".sens param=R1,L1,Vin,... [meas=a,b] [method=auto|forward|adjoint]";

class SensitivityReader {
 public:
  SensitivityReader(const Card& card, Scope& scope, Reporter& reporter) : card_(card), scope_(scope), reporter_(reporter) {
    result_.span = card.span;
  }

  std::optional<SensitivityAnalysis> read() {
    for (const Item& item : card_.items) {
      if (item.kind == ItemKind::assignment)
        take_assignment(item);
      else if (list_ != nullptr)
        (this->*list_)(item);
      else
        return refuse_output(item);
      if (!ok_) return std::nullopt;
    }
    if (result_.parameters.empty()) return fail("E-sens-unknown-parameter", card_.span, ".sens names no parameter");
    return ok_ ? std::optional(std::move(result_)) : std::nullopt;
  }

 private:
  std::nullopt_t fail(std::string id, SourceSpan span, std::string_view what) {
    if (ok_) reporter_.error(std::move(id), span, fmt::format("{}; usage: {}", what, sens_usage));
    ok_ = false;
    return std::nullopt;
  }

  /// `.sens v(out)` of ngspice.
  std::nullopt_t refuse_output(const Item& item) {
    return fail(
        "E-sens-no-measurement", item.span,
        fmt::format("'{}' is not a parameter: .sens takes derivatives of measurements; try .meas tran x find {} at=..., and .sens param=R1",
                    reporter_.text(item.span), reporter_.text(item.span)));
  }

  void take_assignment(const Item& item) {
    list_ = nullptr;
    if (same_name(item.text, "objfunc") || same_name(item.text, "objvars")) {
      (void)fail("E-sens-no-measurement", item.span,
                 fmt::format("{}= is not read: .sens takes derivatives of measurements; try .meas with the expression, and .sens param=R1",
                             item.text));
      return;
    }
    if (item.items.empty()) {
      (void)fail("E-missing-value", item.span, fmt::format("a value is missing after {}=", item.text));
      return;
    }
    if (same_name(item.text, "param")) {
      list_ = &SensitivityReader::take_parameter;
    } else if (same_name(item.text, "meas")) {
      list_ = &SensitivityReader::take_measurement;
    } else if (same_name(item.text, "method")) {
      return take_method(item.items[0]);
    } else {
      (void)fail("E-unexpected", item.span, fmt::format("unknown parameter '{}'", item.text));
      return;
    }
    for (const Item& value : item.items) (this->*list_)(value);
  }

  static std::string without_spaces(std::string_view text) {
    std::string name;
    for (const char c : text)
      if (c != ' ' && c != '\t' && c != ',') name += c;
    return name;
  }

  void take_parameter(const Item& item) {
    if (item.kind == ItemKind::vector) {
      for (const Item& each : item.items) take_parameter(each);
      return;
    }
    SensitivityAnalysis::Parameter parameter;
    parameter.name = without_spaces(reporter_.text(item.span));
    parameter.span = item.span;
    const auto same = [&](const SensitivityAnalysis::Parameter& other) { return same_name(other.name, parameter.name); };
    if (std::any_of(result_.parameters.begin(), result_.parameters.end(), same)) return;
    if (item.kind == ItemKind::word && scope_.knows(parameter.name)) {
      parameter.number = static_cast<int>(scope_.session().varied.size());
      scope_.session().varied.push_back(without_case(parameter.name));
    }
    result_.parameters.push_back(std::move(parameter));
  }

  void take_measurement(const Item& item) { result_.measurements.push_back(without_spaces(reporter_.text(item.span))); }

  void take_method(const Item& value) {
    using Method = SensitivityAnalysis::Method;
    if (is_word(value, "auto"))
      result_.method = Method::automatic;
    else if (is_word(value, "forward"))
      result_.method = Method::forward;
    else if (is_word(value, "adjoint"))
      result_.method = Method::adjoint;
    else
      (void)fail("E-unexpected", value.span, fmt::format("method={} is not known", reporter_.text(value.span)));
  }

  const Card& card_;
  Scope& scope_;
  Reporter& reporter_;
  SensitivityAnalysis result_;
  void (SensitivityReader::*list_)(const Item&) = nullptr;  ///< where further words of a list go
  bool ok_ = true;
};

std::vector<std::string> measurement_names(const FlatCircuit& circuit) {
  std::vector<std::string> names;
  for (const Measurements* measurements : {&circuit.measurements, &circuit.orbit_measurements})
    for (const Measurement& measurement : measurements->list)
      if (measurement.shown) names.push_back(measurement.name);
  return names;
}

}  // namespace

bool SensitivityAnalysis::wants(std::string_view measurement) const {
  return measurements.empty() ||
         std::any_of(measurements.begin(), measurements.end(), [&](const std::string& name) { return same_name(name, measurement); });
}

void read_sensitivities(const Definitions& definitions, Scope& scope, Reporter& reporter, FlatCircuit& circuit) {
  const auto& cards = definitions.sensitivities;
  if (cards.empty() || cards.back()->damaged) return;
  for (std::size_t k = 0; k + 1 < cards.size(); ++k)
    reporter.warning("W-ignored-card", cards[k]->name_span,
                     fmt::format("this .sens is ignored: the last one is used, at {}", reporter.where(cards.back()->span)));
  circuit.analyses.sensitivities = SensitivityReader(*cards.back(), scope, reporter).read();
}

void check_sensitivities(Reporter& reporter, const FlatCircuit& circuit) {
  if (!circuit.analyses.sensitivities) return;
  const SensitivityAnalysis& card = *circuit.analyses.sensitivities;
  const std::vector<std::string> names = measurement_names(circuit);
  if (names.empty()) {
    if (!reporter.failed())
      reporter.error("E-sens-no-measurement", card.span, "the deck measures nothing to differentiate; try .meas tran x avg v(out)");
    return;
  }
  for (const std::string& wanted : card.measurements)
    if (std::none_of(names.begin(), names.end(), [&](const std::string& name) { return same_name(name, wanted); }))
      reporter.error("E-sens-no-measurement", card.span, fmt::format("no .meas is called '{}'{}", wanted, suggestion(wanted, names)));
}

void take_parameter_values(Scope& scope, FlatCircuit& circuit) {
  if (!circuit.analyses.sensitivities) return;
  for (SensitivityAnalysis::Parameter& parameter : circuit.analyses.sensitivities->parameters)
    if (parameter.number >= 0) parameter.value = scope.own_value(parameter.name).value_or(0.0);
  circuit.unfollowed = scope.take_written(0);
  for (const ParameterText& text : scope.definition().parameters) circuit.parameter_names.push_back(text.name);
}

}  // namespace pwlsim::circuit
