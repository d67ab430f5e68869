#include "analysis/report.hpp"

#include <fmt/format.h>

#include <cassert>
#include <set>
#include <string>
#include <string_view>

#include "analysis/json.hpp"
#include "analysis/quantity.hpp"
#include "waveform/csv.hpp"

namespace pwlsim::analysis {
namespace {

std::string residual(double value) { return value == 0.0 ? "0" : fmt::format("{:.1e}", value); }

std::string jump_line(const engine::Jump& jump) {
  std::vector<std::string> impulses, states;
  for (const auto& impulse : jump.impulses)
    impulses.push_back(
        json_line({{"element", json_string(impulse.element)}, {"value", json_number(impulse.value)}, {"unit", json_string(impulse.unit)}}));
  for (const auto& state : jump.states)
    states.push_back(
        json_line({{"name", json_string(state.name)}, {"before", json_number(state.before)}, {"after", json_number(state.after)}}));
  return json_line({{"time", json_number(jump.time)},
                    {"impulses", json_line(impulses)},
                    {"higher_order", json_truth(jump.higher_order)},
                    {"states", json_line(states)},
                    {"energy_before", json_number(jump.energy_before)},
                    {"energy_after", json_number(jump.energy_after)},
                    {"energy_lost", json_number(jump.energy_before - jump.energy_after)}});
}

/// Of a state by its name, "v(C1)"; those of a raw system have none.
std::string unit_of(const std::string& state) {
  switch (state[0]) {
    case 'v':
      return "V";
    case 'i':
      return "A";
    case 'f':
      return "Vs";
    default:
      return "";
  }
}

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
  JsonWriter json;
  write_statistics(json, report);
  return json.take();
}

void write_certificate(JsonWriter& json, const engine::Certificate& certificate) {
  json.key("certificate");
  json.begin_object();
  json.member("complementarity", json_number(certificate.complementarity));
  json.member("kcl_kvl", json_number(certificate.kcl_kvl));
  json.member("energy", json_number(certificate.energy));
  if (certificate.error_bound) {
    json.member("error_bound", json_number(*certificate.error_bound));
    json.member("error_holds", json_truth(certificate.error_holds));
  }
  json.member("passive", certificate.has_passivity ? json_truth(certificate.passive) : "null");
  json.member("points_checked", std::to_string(certificate.points_checked));
  json.end_object();
}

void write_counts(JsonWriter& json, const RunReport& report) {
  const engine::Statistics& s = report.statistics;
  const auto count = [&](std::string_view name, std::uint64_t value) { json.member(name, std::to_string(value)); };
  if (report.runs > 0) {
    count("runs", report.runs);
    count("failed_runs", report.failed_runs);
  }
  count("islands", s.islands);
  count("states", s.states);
  count("ports", s.ports);
  count("switches", s.switches);
  count("modes_visited", s.modes_visited);
  count("events", s.events);
  count("jumps", s.jumps);
  count("accumulations", s.accumulations);
  count("lcp_pivots", s.lcp_pivots);
  count("klu_factorizations", s.klu_factorizations);
  count("klu_solves", s.klu_solves);
  count("steps", s.steps);
  count("rows", s.rows);
}

void write_seconds(JsonWriter& json, const Seconds& seconds) {
  const auto number = [&](std::string_view name, double value) { json.member(name, json_number(value)); };
  json.key("seconds");
  json.begin_object();
  number("parse", seconds.parse);
  number("flatten", seconds.flatten);
  number("model", seconds.model);
  number("simulate", seconds.simulate);
  number("write", seconds.write);
  number("certificate", seconds.certificate);
  number("total", seconds.total);
  json.end_object();
}

void write_statistics(JsonWriter& json, const RunReport& report) {
  json.begin_object();
  json.member("engine", json_string(report.engine));
  write_counts(json, report);
  json.key("jump_details");
  json.begin_array();
  for (const engine::Jump& jump : report.jumps) json.value(jump_line(jump));
  json.end_array();
  write_seconds(json, report.seconds);
  write_certificate(json, report.certificate);
  json.key("notes");
  json.begin_array();
  for (const std::string& note : report.notes) json.value(json_string(note));
  json.end_array();
  json.end_object();
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

std::vector<std::string> jump_texts(const std::vector<engine::Jump>& jumps, std::uint64_t all, const circuit::HiddenParts& hidden) {
  constexpr std::size_t most_told = 20;
  const auto is_hidden = [&](const engine::Jump& jump) {
    return !jump.states.empty() && std::all_of(jump.states.begin(), jump.states.end(), [&](const engine::Jump::State& state) {
      const std::size_t begin = state.name.find('(') + 1;
      return hidden.hold(std::string_view(state.name).substr(begin, state.name.find(')') - begin));
    });
  };
  std::vector<std::string> texts;
  std::set<double> told, visible, hidden_only;  // instants, as `all` counts them
  for (const engine::Jump& jump : jumps) {
    const bool hides = is_hidden(jump);
    (hides ? hidden_only : visible).insert(jump.time);
    if (hides || texts.size() >= most_told) continue;
    texts.push_back(jump_text(jump));
    told.insert(jump.time);
  }
  std::erase_if(hidden_only, [&](double time) { return visible.contains(time); });
  const std::uint64_t known = told.size() + hidden_only.size();
  if (all > known && !texts.empty())
    texts.push_back(fmt::format("and jumps at {} more instants; --stats lists the first thousand", all - known));
  return texts;
}

std::string operating_point_text(std::span<const std::string> names, std::span<const double> values, int digits) {
  assert(names.size() == values.size());
  std::string text;
  for (std::size_t index = 0; index < names.size(); ++index) text += names[index] + " = " + waveform::rounded(values[index], digits) + '\n';
  return text;
}

}  // namespace pwlsim::analysis
