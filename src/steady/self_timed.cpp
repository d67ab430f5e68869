#include "steady/self_timed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/names.hpp"
#include "linalg/factorisations.hpp"
#include "steady/subharmonic.hpp"
#include "steady/tolerances.hpp"

namespace pwlsim::steady {
namespace {

using engine::InstantView;
using engine::RunState;

constexpr int recurrences = 5;   ///< of an event before its orbit is looked for
constexpr double growth = 16.0;  ///< of the time that is looked at, as long as too little happens
constexpr int most_extensions = 6;
constexpr double time_constants = 8.0;  ///< the first look
constexpr double periods_per_hint = 50.0;
constexpr double first_instant = 1e-12;       ///< s: all that happens at the begin
constexpr int most_other_instants = 100'000;  ///< while the event that was asked for does not come

/// The mode that a change leads to; where it leads back to the one before, the first other one on the way, in which the circuit is for no time. Null: there is none.
const model::Mode* mode_changed_to(const engine::Change& change) {
  if (change.before == nullptr) return nullptr;
  if (!(change.before->active == change.after->active)) return change.after;
  for (const model::Mode* const way : change.by_way_of)
    if (!(way->active == change.before->active)) return way;
  return nullptr;
}

/// What an instant changes: the modes and switches right of it, where something changed.
std::string signature(const InstantView& view, const std::vector<char>& before) {
  std::string text;
  for (const engine::Change& change : view.changes) {
    const model::Mode* const to = mode_changed_to(change);
    if (to == nullptr) continue;
    text += fmt::format("{}{}", change.island, to == change.after ? ':' : '~');
    const int ports = to->guards.rows() > 0 ? static_cast<int>(to->k.rows()) : 0;
    for (int i = 0; i < ports; ++i) {
      const bool was = change.before->active.contains(i), is = to->active.contains(i);
      if (was != is) text += fmt::format("{}{}", is ? '+' : '-', i);
    }
  }
  for (std::size_t i = 0; i < before.size(); ++i)
    if (before[i] != view.on[i]) text += fmt::format(";{}{}", view.on[i] != 0 ? '+' : '-', i);
  return text;
}

/// Ends a run when an event has recurred often enough, and remembers which.
class Counter {
 public:
  bool operator()(const InstantView& view, const std::vector<char>& before) {
    const std::string what = signature(view, before);
    if (what.empty() || view.time <= 0.0) return false;
    last_time_ = view.time;
    if (++count_[what] < recurrences) return false;
    found_ = what;
    return true;
  }
  [[nodiscard]] const std::string& found() const { return found_; }
  [[nodiscard]] double last_time() const { return last_time_; }

 private:
  std::map<std::string, int> count_;
  std::string found_;
  double last_time_ = 0.0;
};

/// s: when the last guard of the modes that the trace ends in would be passed, straight on. Integrators have no other time.
double last_passage(const Trace& trace) {
  double longest = 0.0;
  for (const TraceSegment& segment : trace.tail) {
    const model::Mode& mode = *segment.mode;
    const Eigen::Map<const Vector> y(segment.y1.data(), mode.ny);
    const Vector value = mode.guards * y, rate = mode.guards * (mode.flow.a() * y);
    for (Eigen::Index k = 0; k < value.size(); ++k)
      if (rate[k] != 0.0) longest = std::max(longest, std::abs(value[k] / rate[k]));
  }
  return longest;
}

/// s: the slowest motion of the modes that the trace ends in.
double slowest(const Trace& trace) {
  double longest = 0.0;
  const auto look = [&](const TraceSegment& segment) {
    const model::Mode& mode = *segment.mode;
    if (mode.n1 == 0) return;
    const Eigen::EigenSolver<Matrix> eigen(Matrix(mode.flow.a().topLeftCorner(mode.n1, mode.n1)), false);
    const double largest = eigen.eigenvalues().cwiseAbs().maxCoeff();
    for (const auto& value : eigen.eigenvalues())
      if (std::abs(value) > tolerance::resting_rate * largest) longest = std::max(longest, 1.0 / std::abs(value));
  };
  for (const TraceSegment& segment : trace.tail) look(segment);
  return longest;
}

class Finder {
 public:
  Finder(engine::March& march, const SelfTimedTask& task) : march_(march), task_(task) {}

  Orbit run(const RunState& start) {
    RunState state = start;
    if (task_.settling_time > 0.0) march_.advance(state, task_.settling_time, nullptr);
    double horizon = task_.hint > 0.0 ? periods_per_hint * task_.hint : task_.horizon;
    if (horizon <= 0.0) horizon = first_horizon(state);
    for (int extension = 0; extension < most_extensions && horizon > 0.0; ++extension, horizon *= growth) {
      RunState at = state;
      const std::optional<Section> section = recurring(at, horizon);
      if (failed_) return std::move(orbit_);
      if (!section) continue;
      OrbitTask task = task_.orbit;
      task.section = *section;
      task.longest = horizon;
      task.periods_before = 0;
      Orbit orbit = find_orbit(march_, at, task);
      orbit.periods_simulated += recurrences;
      orbit.section = section->name;
      if (task.multiple > 1 && orbit.verdict == Verdict::found) {
        task.period = orbit.period;
        orbit.repeats_after = repeats_after(march_, orbit, task);
      }
      return orbit;
    }
    orbit_.verdict = Verdict::no_event;
    return std::move(orbit_);
  }

 private:
  double first_horizon(const RunState& state) {
    RunState at = state;
    TraceRecorder recorder(at.on);
    march_.advance(at, first_instant, &recorder);
    const Trace trace = recorder.take();
    const double longest = slowest(trace);
    return time_constants * (longest > 0.0 ? longest : last_passage(trace));
  }

  /// Runs to where an event has recurred, `state` then being right of it.
  std::optional<Section> recurring(RunState& state, double horizon) {
    Counter counter;
    int count = 0, others = 0;
    const EndsAt ends = [&](const InstantView& view, const std::vector<char>& before) {
      if (!task_.section) return counter(view, before);
      if (view.time > 0.0 && task_.section->is_passed(view, before)) return ++count == recurrences;
      return ++others == most_other_instants;
    };
    TraceRecorder recorder(state.on, ends);
    const engine::Answer answer = march_.advance(state, horizon, &recorder);
    orbit_.answer = answer;
    failed_ = answer.outcome != engine::Outcome::completed;
    if (failed_) orbit_.verdict = answer.outcome == engine::Outcome::interrupted ? Verdict::interrupted : Verdict::run_failed;
    if (!recorder.has_ended()) return std::nullopt;
    if (others == most_other_instants) {
      failed_ = true;
      orbit_.verdict = Verdict::no_event;
    }
    if (task_.section) return task_.section;
    return Section{event_text(recorder), [what = counter.found()](const InstantView& view, const std::vector<char>& before) {
                     return signature(view, before) == what;
                   }};
  }

  std::string event_text(TraceRecorder& recorder) {
    const Trace trace = recorder.take();
    const TraceStep& last = trace.steps.back();
    const std::vector<char>& before = trace.steps.size() > 1 ? trace.steps[trace.steps.size() - 2].on : last.on;
    for (std::size_t i = 0; i < last.on.size(); ++i)
      if (before[i] != last.on[i]) return fmt::format("{} {}", march_.model().switches[i].name, last.on[i] != 0 ? "closes" : "opens");
    for (const engine::Change& change : last.changes) {
      const model::Mode* const to = mode_changed_to(change);
      if (to == nullptr) continue;
      const model::System& system = march_.model().islands[change.island].extraction.system;
      for (int i = 0; i < system.ports; ++i) {
        const bool is = to->active.contains(i);
        const model::Port& port = system.port[static_cast<std::size_t>(i)];
        if (change.before->active.contains(i) == is) continue;
        const bool conducts = is == port.input_is_current;
        if (i < system.diodes) return fmt::format("{} {}", port.name, conducts ? "conducts" : "blocks");
        return fmt::format("{} {}", port.name, conducts ? "closes" : "opens");
      }
    }
    return "a change of mode";
  }

  engine::March& march_;
  const SelfTimedTask& task_;
  Orbit orbit_;
  bool failed_ = false;
};

}  // namespace

namespace {

/// Whether the switch changes and changes back at this instant.
bool returns_at_once(const engine::SwitchInfo& info, const InstantView& view) {
  if (info.port < 0) return false;
  return std::any_of(view.changes.begin(), view.changes.end(), [&](const engine::Change& change) {
    if (change.island != static_cast<std::size_t>(info.island) || change.before == nullptr) return false;
    const bool was = change.before->active.contains(info.port);
    if (change.after->active.contains(info.port) != was) return false;
    return std::any_of(change.by_way_of.begin(), change.by_way_of.end(),
                       [&](const model::Mode* way) { return way->active.contains(info.port) != was; });
  });
}

}  // namespace

Orbit find_self_timed_orbit(engine::March& march, const engine::RunState& start, const SelfTimedTask& task) {
  return Finder(march, task).run(start);
}

std::optional<Section> section_of(const engine::ExactModel& model, std::string_view element, bool closes) {
  const std::string name = fmt::format("{} {}", element, closes ? "closes" : "opens");
  for (std::size_t i = 0; i < model.switches.size(); ++i)
    if (same_name(model.switches[i].name, element) && model.switches[i].island >= 0)
      return Section{name, [i, closes, &info = model.switches[i]](const InstantView& view, const std::vector<char>& before) {
                       if (before[i] != view.on[i]) return (view.on[i] != 0) == closes;
                       return returns_at_once(info, view);
                     }};
  for (std::size_t island = 0; island < model.islands.size(); ++island) {
    const model::System& system = model.islands[island].extraction.system;
    for (int i = 0; i < system.diodes; ++i) {
      const model::Port& port = system.port[static_cast<std::size_t>(i)];
      if (!same_name(port.name, element)) continue;
      const bool active = closes == port.input_is_current;
      return Section{name, [island, i, active](const InstantView& view, const std::vector<char>&) {
                       return std::any_of(view.changes.begin(), view.changes.end(), [&](const engine::Change& change) {
                         return change.island == island && change.before != nullptr && change.before->active.contains(i) != active &&
                                change.after->active.contains(i) == active;
                       });
                     }};
    }
  }
  return std::nullopt;
}

}  // namespace pwlsim::steady
