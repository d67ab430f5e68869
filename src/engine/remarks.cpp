#include "engine/remarks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace pwlsim::engine {

namespace {

/// So many events in a crowd are an accumulation that cannot be crossed.
constexpr std::uint64_t crowd_limit = 400;

/// For switches that keep toggling. Those of transistors ("X1.M2") have no hysteresis, but gates that take time.
std::string cure_of(const std::vector<std::string>& switches) {
  const auto is_transistor = [](const std::string& name) {
    const char letter = name[name.find_last_of('.') + 1];  // of none at the end: the first of all
    return letter == 'M' || letter == 'm' || letter == 'J' || letter == 'j';
  };
  if (!std::any_of(switches.begin(), switches.end(), is_transistor)) return "a hysteresis Vh";
  return "a capacitor from gate to source of the transistors, whose gates take no time here, or a source that drives them against their "
         "own source";
}

}  // namespace

void end_run(Answer& answer, Ending ending) {
  answer.outcome = ending.outcome;
  answer.id = std::move(ending.id);
  answer.message = std::move(ending.text);
  answer.elements = std::move(ending.elements);
}

Ending interrupted(double time) { return {Outcome::interrupted, "E-interrupted", fmt::format("stopped at t = {} s by a signal", time)}; }

Ending keeps_toggling(double time, std::vector<std::string> switches) {
  switches.erase(std::unique(switches.begin(), switches.end()), switches.end());  // a comparison is two
  std::string text = fmt::format("the switches {}{}keep toggling at t = {} s: each state violates its own condition; try {}",
                                 fmt::join(switches, ", "), switches.empty() ? "" : " ", time, cure_of(switches));
  return {Outcome::no_solution, "E-no-settle", std::move(text), std::move(switches)};
}

bool Crowd::note(double time, double length) {
  if (time - start > length) *this = {time, 0};
  return ++count >= crowd_limit;
}

Ending accumulation(double time, const Crowd& crowd, std::vector<std::string> names, const std::string& part) {
  std::string where = names.empty() ? part : fmt::format("at {}", fmt::join(names, ", "));
  if (!where.empty()) where = ", " + where;
  std::string text =
      fmt::format("events accumulate at t = {} s ({} of them within {} s){}; try a resistor, capacitor or hysteresis that separates them",
                  time, crowd.count, time - crowd.start, where);
  return {Outcome::accumulation, "E-accumulation", std::move(text), std::move(names)};
}

Remark doubtful_certificate(double worst) {
  return {"W-certificate", fmt::format("the certificate's worst residual is {:.1e}: trust no more digits than that; parts of the circuit "
                                       "are too fast, or too far apart in size, for double precision",
                                       worst)};
}

Remark projected_start() {
  return {"W-start-projected",
          "the initial values contradict the circuit; they are projected at t = 0 like any jump, conserving charge and flux"};
}

Remark starts_without_operating_point(const std::string& what) {
  return {"W-no-operating-point", what + ". It starts from the values of .ic, and from zero elsewhere; try uic, which also uses ic="};
}

Remark operating_point_not_unique(const std::string& part, const std::string& which) {
  return {"W-op-not-unique", "the DC operating point of the part with " + part +
                                 " is not unique (a loop without resistance or a floating capacitor); the run starts from " + which};
}

Remark indeterminate(const std::set<std::string>& signals) {
  return {
      "N-indeterminate",
      fmt::format("{}: the circuit does not determine how currents divide, or the potential of a floating part, in some of its modes; the "
                  "rows hold the values of least norm",
                  fmt::join(signals, ", ")),
      {signals.begin(), signals.end()}};
}

void ModeText::add(const std::string& name, bool is_on) {
  if (sides_.empty() || sides_.back().name != name) sides_.push_back({name, false});
  sides_.back().is_on |= is_on;
}

std::string ModeText::side(bool is_on) const {
  constexpr std::size_t most_names = 8;
  std::vector<std::string> names;
  for (const Side& side : sides_)
    if (side.is_on == is_on) names.push_back(side.name);
  const std::size_t more = names.size() > most_names ? names.size() - most_names : 0;
  names.resize(names.size() - more);
  std::string text = fmt::format("{}", fmt::join(names, ", "));
  if (more > 0) text += fmt::format(" and {} more", more);
  if (!text.empty()) text += is_on ? " on" : " off";
  return text;
}

std::string ModeText::str() const {
  const std::string on = side(true), off = side(false);
  return on + (on.empty() || off.empty() ? "" : ", ") + off;
}

}  // namespace pwlsim::engine
