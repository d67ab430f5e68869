#include "elements/parameter.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/names.hpp"

namespace pwlsim::elements {

const Parameter* find_parameter(ParameterTable table, std::string_view name) {
  const auto found = std::find_if(table.begin(), table.end(), [&](const Parameter& p) { return same_name(p.name, name); });
  return found == table.end() ? nullptr : &*found;
}

bool in_range(const Parameter& parameter, double value) {
  if (std::isnan(value)) return false;
  if (std::isinf(value) && !parameter.infinity_allowed) return false;
  switch (parameter.range) {
    case Range::any:
      return true;
    case Range::not_negative:
      return value >= 0.0;
    case Range::positive:
      return value > 0.0;
    case Range::whole_positive:
      return value >= 1.0 && (std::isinf(value) || value == std::floor(value));
    case Range::minus_one_to_one:
      return value >= -1.0 && value <= 1.0;
  }
  return false;
}

std::string_view range_words(Range range) {
  switch (range) {
    case Range::any:
      return "must be finite";
    case Range::not_negative:
      return "must not be negative";
    case Range::positive:
      return "must be positive";
    case Range::whole_positive:
      return "must be a whole number, 1 or more";
    case Range::minus_one_to_one:
      return "must lie between -1 and 1";
  }
  return "";
}

void Values::set_list(std::string_view name, std::vector<double> list, SourceSpan span) {
  const Parameter* parameter = find_parameter(table_, name);
  assert(parameter != nullptr && !list.empty());
  const double first = list[0];
  for (Given& given : given_) {
    if (given.parameter != parameter) continue;
    given = {parameter, first, span, std::move(list)};
    return;
  }
  given_.push_back({parameter, first, span, std::move(list)});
}

const Values::Given* Values::find(std::string_view name) const {
  const auto found = std::find_if(given_.begin(), given_.end(), [&](const Given& g) { return same_name(g.parameter->name, name); });
  return found == given_.end() ? nullptr : &*found;
}

double Values::get(std::string_view name) const {
  if (const Given* given = find(name)) return given->value;
  const Parameter* parameter = find_parameter(table_, name);
  assert(parameter != nullptr);
  return parameter->fallback;
}

std::vector<double> Values::list(std::string_view name) const {
  if (const Given* given = find(name)) return given->list;
  return {get(name)};
}

SourceSpan Values::span(std::string_view name) const {
  const Given* given = find(name);
  return given != nullptr ? given->span : SourceSpan{};
}

}  // namespace pwlsim::elements
