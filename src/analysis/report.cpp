#include "analysis/report.hpp"

#include <fmt/format.h>

#include <cassert>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "analysis/json.hpp"
#include "analysis/quantity.hpp"
#include "waveform/csv.hpp"

namespace pwlsim::analysis {
namespace {

std::string json_object(std::initializer_list<std::pair<std::string_view, std::string>> members, std::string_view indent) {
  std::string result = "{";
  std::string_view separator = "\n";
  for (const auto& [key, value] : members) {
    result += fmt::format("{}{}  \"{}\": {}", separator, indent, key, value);
    separator = ",\n";
  }
  return result + fmt::format("\n{}}}", indent);
}

std::string json_array(const std::vector<std::string>& strings) {
  std::string result = "[";
  for (const std::string& text : strings) result += (result.size() == 1 ? "\n    " : ",\n    ") + json_string(text);
  return result + (strings.empty() ? "]" : "\n  ]");
}

std::string residual(double value) { return value == 0.0 ? "0" : fmt::format("{:.1e}", value); }

std::string counted(std::uint64_t count, std::string_view noun) { return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s"); }

std::string jump_details(const std::vector<engine::Jump>& jumps) {
  std::vector<std::string> items;
  for (const engine::Jump& jump : jumps) {
    std::vector<std::string> impulses, states;
    for (const auto& impulse : jump.impulses)
      impulses.push_back(json_line(
          {{"element", json_string(impulse.element)}, {"value", json_number(impulse.value)}, {"unit", json_string(impulse.unit)}}));
    for (const auto& state : jump.states)
      states.push_back(
          json_line({{"name", json_string(state.name)}, {"before", json_number(state.before)}, {"after", json_number(state.after)}}));
    items.push_back(json_line({{"time", json_number(jump.time)},
                               {"impulses", json_line(impulses)},
                               {"higher_order", json_truth(jump.higher_order)},
                               {"states", json_line(states)},
                               {"energy_before", json_number(jump.energy_before)},
                               {"energy_after", json_number(jump.energy_after)},
                               {"energy_lost", json_number(jump.energy_before - jump.energy_after)}}));
  }
  std::string text = "[";
  for (const std::string& item : items) text += (text.size() > 1 ? ",\n    " : "\n    ") + item;
  return text + (items.empty() ? "]" : "\n  ]");
}

std::string unit_of(const std::string& state) { return state[0] == 'v' ? "V" : state[0] == 'i' ? "A" : "Vs"; }

std::string jump_text(const engine::Jump& jump) {
  constexpr int digits = 6;
  std::vector<std::string> parts;
  for (const auto& impulse : jump.impulses)
    parts.push_back(
        fmt::format("{} {} {}", impulse.element, impulse.unit == "C" ? "passes" : "takes", quantity(impulse.value, impulse.unit, digits)));
  std::vector<std::string> states;
  for (const auto& state : jump.states) {
    const std::string unit = unit_of(state.name);
    states.push_back(
        fmt::format("{} from {} to {}", state.name, quantity(state.before, unit, digits), quantity(state.after, unit, digits)));
  }
  return fmt::format("jump at t = {}: {}{}; {}; stored energy from {} to {}", quantity(jump.time, "s"), fmt::join(parts, ", "),
                     jump.higher_order ? " and impulses of higher order" : "", fmt::join(states, ", "),
                     quantity(jump.energy_before, "J", digits), quantity(jump.energy_after, "J", digits));
}

}  // namespace

std::string statistics_json(const RunReport& report) {
  const engine::Statistics& s = report.statistics;
  const engine::Certificate& c = report.certificate;
  const Seconds& t = report.seconds;
  const auto number = [](std::uint64_t value) { return fmt::format("{}", value); };
  const std::string seconds = json_object({{"parse", json_number(t.parse)},
                                           {"flatten", json_number(t.flatten)},
                                           {"model", json_number(t.model)},
                                           {"simulate", json_number(t.simulate)},
                                           {"write", json_number(t.write)},
                                           {"certificate", json_number(t.certificate)},
                                           {"total", json_number(t.total)}},
                                          "  ");
  const std::string certificate = json_object({{"complementarity", json_number(c.complementarity)},
                                               {"kcl_kvl", json_number(c.kcl_kvl)},
                                               {"energy", json_number(c.energy)},
                                               {"passive", !c.has_passivity ? "null"
                                                           : c.passive      ? "true"
                                                                            : "false"},
                                               {"points_checked", number(c.points_checked)}},
                                              "  ");
  return json_object({{"engine", json_string(report.engine)},
                      {"islands", number(s.islands)},
                      {"states", number(s.states)},
                      {"ports", number(s.ports)},
                      {"switches", number(s.switches)},
                      {"modes_visited", number(s.modes_visited)},
                      {"events", number(s.events)},
                      {"jumps", number(s.jumps)},
                      {"accumulations", number(s.accumulations)},
                      {"lcp_pivots", number(s.lcp_pivots)},
                      {"klu_factorizations", number(s.klu_factorizations)},
                      {"klu_solves", number(s.klu_solves)},
                      {"steps", number(s.steps)},
                      {"rows", number(s.rows)},
                      {"jump_details", jump_details(report.jumps)},
                      {"seconds", seconds},
                      {"certificate", certificate},
                      {"notes", json_array(report.notes)}},
                     "") +
         "\n";
}

std::string summary(const RunReport& report, const std::string& output, double stop) {
  const engine::Certificate& c = report.certificate;
  return fmt::format("wrote {}: {}, {} to t = {} in {}; worst residuals: complementarity {}, KCL/KVL {}, energy {}{}\n", output,
                     counted(report.statistics.rows, "row"), counted(report.statistics.events, "event"), quantity(stop, "s"),
                     quantity(report.seconds.simulate, "s", 3), residual(c.complementarity), residual(c.kcl_kvl), residual(c.energy),
                     !c.has_passivity ? ""
                     : c.passive      ? "; passive"
                                      : "; not passive");
}

std::string details(const RunReport& report) {
  const engine::Statistics& s = report.statistics;
  const Seconds& t = report.seconds;
  const auto time = [](double value) { return quantity(value, "s", 3); };
  return fmt::format("engine {}: {}, {}, {}, {}; {} visited, {}, {}\n", report.engine, counted(s.islands, "island"),
                     counted(s.states, "state"), counted(s.ports, "port"),
                     s.switches == 1 ? "1 switch" : fmt::format("{} switches", s.switches), counted(s.modes_visited, "mode"),
                     counted(s.jumps, "jump"), counted(s.lcp_pivots, "LCP pivot")) +
         fmt::format("time: parse {}, flatten {}, model {}, simulate {}, write {}, certificate {}, total {}\n", time(t.parse),
                     time(t.flatten), time(t.model), time(t.simulate), time(t.write), time(t.certificate), time(t.total));
}

std::vector<std::string> jump_texts(const std::vector<engine::Jump>& jumps, std::uint64_t all) {
  constexpr std::size_t most_told = 20;
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < jumps.size() && i < most_told; ++i) texts.push_back(jump_text(jumps[i]));
  if (all > texts.size())
    texts.push_back(fmt::format("and jumps at {} more instants; --stats lists the first thousand", all - texts.size()));
  return texts;
}

std::string operating_point_text(std::span<const std::string> names, std::span<const double> values) {
  assert(names.size() == values.size());
  std::string text;
  for (std::size_t index = 0; index < names.size(); ++index) text += names[index] + " = " + waveform::shortest(values[index]) + '\n';
  return text;
}

}  // namespace pwlsim::analysis
