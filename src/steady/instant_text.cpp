#include <fmt/format.h>
#include <fmt/ranges.h>

#include "steady/sensitivity.hpp"
#include "steady/tolerances.hpp"

namespace pwlsim::steady {
namespace {

void add_changes(const model::System& system, const engine::Change& change, std::vector<std::string>& events) {
  if (change.before == nullptr) return;
  for (int i = 0; i < system.ports; ++i) {
    if (change.before->active.contains(i) == change.after->active.contains(i)) continue;
    const model::Port& port = system.port[static_cast<std::size_t>(i)];
    const bool is_switch = i >= system.diodes;
    bool on = change.after->active.contains(i) == port.input_is_current;
    if (is_switch && system.switch_inverted[static_cast<std::size_t>(i - system.diodes)] != 0) on = !on;
    events.push_back(fmt::format("{} {}", port.name, is_switch ? (on ? "closes" : "opens") : (on ? "conducts" : "blocks")));
  }
}

}  // namespace

std::string Sensitivity::instant_text(std::size_t instant) const {
  const double time = orbit_.instants()[instant].time;
  const TraceStep& step = instant == 0 && is_settled_ ? wrap_ : trace_.steps[instant];
  std::vector<std::string> events;
  for (const engine::Change& change : step.changes) add_changes(orbit_.stacking().system(change.island), change, events);
  if (events.empty())
    for (const Wave& wave : jumping_)
      if (edge_shift(wave, time, tolerance::same_instant * (length_ + time), is_settled_)) events.push_back(wave.name + " has an edge");
  return fmt::format("{} at t = {} s", events.empty() ? "an event lies" : fmt::format("{}", fmt::join(events, ", ")), time);
}

}  // namespace pwlsim::steady
