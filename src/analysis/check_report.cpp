#include <fmt/format.h>

#include <algorithm>

#include "analysis/check.hpp"
#include "analysis/json.hpp"

namespace pwlsim::analysis {
namespace {

const char* word(Agreement agreement) {
  switch (agreement) {
    case Agreement::agrees:
      return "agrees";
    case Agreement::differs:
      return "differs";
    case Agreement::undecided:
      break;
  }
  return "no verdict";
}

void write_levels(JsonWriter& json, const Check& check) {
  json.key("levels");
  json.begin_array();
  for (const CheckLevel& level : check.levels)
    json.value(json_line({{"engine", json_string(level.engine)},
                          {"reltol", level.reltol == 0.0 ? "null" : json_number(level.reltol)},
                          {"seconds", json_number(level.seconds)},
                          {"failure", level.failure.empty() ? "null" : json_string(level.failure)}}));
  json.end_array();
}

void write_signals(JsonWriter& json, const Check& check) {
  json.key("signals");
  json.begin_array();
  for (const CheckedSignal& signal : check.signals)
    json.value(json_line({{"name", json_string(signal.name)},
                          {"maximum", json_number(signal.scale)},
                          {"difference", json_number(signal.difference)},
                          {"at", json_number(signal.time)},
                          {"error", json_number(signal.error)},
                          {"verdict", json_string(word(signal.agreement))}}));
  json.end_array();
}

}  // namespace

std::string check_text(const Check& check) {
  std::string text = fmt::format("{}: {}\n", word(check.agreement), check.reason);
  if (check.signals.empty()) return text;
  std::size_t width = 6;
  for (const CheckedSignal& signal : check.signals) width = std::max(width, signal.name.size());
  text += fmt::format("{:<{}}  {:>11}  {:>10}  {:>12}  {:>15}\n", "signal", width, "maximum", "difference", "at t (s)", "estimated error");
  for (const CheckedSignal& signal : check.signals)
    text += fmt::format("{:<{}}  {:>11.5g}  {:>10.1e}  {:>12.6g}  {:>15.1e}  {}\n", signal.name, width, signal.scale, signal.difference,
                        signal.time, signal.error, word(signal.agreement));
  return text;
}

void write_check(JsonWriter& json, const Check* check) {
  if (check == nullptr) {
    json.member("check", "null");
    return;
  }
  json.key("check");
  json.begin_object();
  json.member("verdict", json_string(word(check->agreement)));
  json.member("reason", json_string(check->reason));
  json.member("rows", std::to_string(check->rows));
  write_levels(json, *check);
  write_signals(json, *check);
  json.end_object();
}

}  // namespace pwlsim::analysis
