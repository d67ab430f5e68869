#include "circuit/values.hpp"

#include <fmt/format.h>

#include "base/names.hpp"
#include "netlist/number.hpp"

namespace pwlsim::circuit {

using elements::Parameter;
using elements::Use;
using netlist::Item;

void ValueReader::warn_of_femto(const Item& value, const Parameter& parameter) {
  // The factor of a capacitor's model is its value where the card has none.
  const bool is_capacitance = parameter.unit == "F" || (parameter.unit.empty() && parameter.name == "C");
  const std::optional<SourceSpan> where = is_capacitance ? scope_.bare_femto(value) : std::nullopt;
  if (!where) return;
  // A number in a parameter may make many capacitances.
  const bool is_elsewhere = where->begin < value.span.begin || where->end > value.span.end || where->file != value.span.file;
  if (is_elsewhere && !reporter_.first_time(fmt::format("femto:{}:{}", where->file, where->begin))) return;
  const std::string_view text = reporter_.text(*where);
  reporter_.warning("W-femto", *where,
                    fmt::format("{} is {} farad: a bare F is femto; leave it out for farad", text, netlist::read_number(text).value));
}

void ValueReader::assignment(const Item& item, elements::Values& values, std::vector<std::string>* ignored) {
  const Parameter* parameter = elements::find_parameter(values.table(), item.text);
  if (parameter == nullptr) return report_unknown(item, values.table(), ignores_unknown_ ? ignored : nullptr);
  if (parameter->use == Use::ignored && ignored != nullptr) {
    ignored->push_back(item.text);
  } else if (parameter->use == Use::ignored) {
    if (reporter_.first_time("ignored:" + without_case(item.text))) {
      reporter_.warning("W-ignored-parameter", item.span, fmt::format("{}= is ignored", item.text));
    }
  } else if (item.items.empty()) {
    reporter_.error("E-missing-value", item.span, fmt::format("{} of {} has no value", item.text, owner_));
  } else if (parameter->use == Use::refused) {
    refuse(item, *parameter);
  } else if (values.has(parameter->name)) {
    reporter_.error("E-duplicate-parameter", item.span, fmt::format("{} of {} is given twice", item.text, owner_));
  } else if (parameter->is_list && item.items[0].kind == Item::Kind::vector) {
    store_list(item.items[0], *parameter, values);
  } else {
    store(item.items[0], *parameter, values);
  }
}

void ValueReader::positional(const Item& item, const Parameter& parameter, elements::Values& values) { store(item, parameter, values); }

void ValueReader::store(const Item& value, const Parameter& parameter, elements::Values& values) {
  if (const std::optional<double> number = checked(value, parameter)) values.set(parameter.name, *number, value.span);
}

void ValueReader::store_list(const Item& values, const Parameter& parameter, elements::Values& result) {
  std::vector<double> list;
  for (const Item& item : values.items)
    if (const std::optional<double> number = checked(item, parameter)) list.push_back(*number);
  if (values.items.empty()) reporter_.error("E-missing-value", values.span, fmt::format("{} of {} has no value", parameter.name, owner_));
  if (!list.empty()) result.set_list(parameter.name, std::move(list), values.span);
}

std::optional<double> ValueReader::checked(const Item& value, const Parameter& parameter) {
  const std::optional<Number> number = scope_.number(value, parameter.infinity_allowed);
  if (!number) return std::nullopt;
  warn_of_femto(value, parameter);
  if (!elements::in_range(parameter, number->value)) {
    reporter_.error("E-range", value.span,
                    fmt::format("{} of {} {}, not {}", parameter.name, owner_, elements::range_words(parameter.range), number->value));
  }
  return number->value;
}

/// A refused parameter may stand where it has the value it has anyway.
void ValueReader::refuse(const Item& item, const Parameter& parameter) {
  const std::optional<Number> number = item.items[0].kind == Item::Kind::word ? scope_.number(item.items[0], true) : std::nullopt;
  if (number && number->value == parameter.fallback) return;
  reporter_.error("E-not-supported", item.span, fmt::format("{} of {} is not supported", item.text, owner_));
}

void ValueReader::report_unknown(const Item& item, elements::ParameterTable table, std::vector<std::string>* ignored) {
  std::vector<std::string> names;
  for (const Parameter& parameter : table) {
    if (parameter.use == Use::honoured) names.emplace_back(parameter.name);
  }
  const std::string nearest = suggestion(item.text, names);
  if (nearest.empty() && ignored != nullptr) return ignored->push_back(item.text);
  const std::string cure = nearest.empty() && !names.empty() ? fmt::format("; it takes {}", fmt::join(names, ", ")) : nearest;
  reporter_.error("E-unknown-parameter", item.text_span, fmt::format("{} has no parameter '{}'{}", owner_, item.text, cure));
}

}  // namespace pwlsim::circuit
