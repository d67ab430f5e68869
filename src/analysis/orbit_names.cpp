#include "analysis/orbit_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/quantity.hpp"
#include "model/store_values.hpp"

namespace pwlsim::analysis {
namespace {

using engine::ExactModel;

/// Island and coordinate in it.
std::pair<std::size_t, int> place_of(const ExactModel& model, std::size_t coordinate) {
  auto left = static_cast<int>(coordinate);
  std::size_t island = 0;
  while (left >= model.islands[island].extraction.system.n) left -= model.islands[island++].extraction.system.n;
  return {island, left};
}

std::string unit_of_store(const std::string& name) {
  return name.starts_with("v(") ? "V" : name.starts_with("i(") ? "A" : name.starts_with("flux(") ? "Vs" : "";
}

/// Which ports conduct, by name.
class Positions {
 public:
  Positions(const ExactModel& model, const circuit::HiddenParts& hidden) : model_(model), hidden_(hidden) {}

  /// What changes, in words.
  std::vector<std::string> take(const engine::Change& change) {
    std::vector<std::string> events;
    const model::System& system = model_.islands[change.island].extraction.system;
    for (int i = 0; i < system.ports; ++i) {
      const model::Port& port = system.port[static_cast<std::size_t>(i)];
      if (hidden_.hold(port.name)) continue;
      const bool is_switch = i >= system.diodes, on = is_on(system, *change.after, i);
      const auto becomes = [&](bool now) { return is_switch ? (now ? "closes" : "opens") : (now ? "conducts" : "blocks"); };
      auto& known = (is_switch ? closed_ : conducting_)[port.name];
      if (known != on) {
        events.push_back(fmt::format("{} {}", port.name, becomes(on)));
      } else if (is_switch && change.before != nullptr && is_on(system, *change.before, i) == on) {
        const auto is_other = [&](const model::Mode* way) { return is_on(system, *way, i) != on; };
        if (std::any_of(change.by_way_of.begin(), change.by_way_of.end(), is_other))
          events.push_back(fmt::format("{} {} and {}", port.name, becomes(!on), becomes(on)));
      }
      known = on;
    }
    return events;
  }
  [[nodiscard]] std::vector<std::string> closed() const { return names(closed_); }
  [[nodiscard]] std::vector<std::string> conducting() const { return names(conducting_); }

 private:
  static bool is_on(const model::System& system, const model::Mode& mode, int port) {
    const bool on = mode.active.contains(port) == system.port[static_cast<std::size_t>(port)].input_is_current;
    const bool is_inverted = port >= system.diodes && system.switch_inverted[static_cast<std::size_t>(port - system.diodes)] != 0;
    return on != is_inverted;
  }
  static std::vector<std::string> names(const std::map<std::string, bool>& ports) {
    std::vector<std::string> list;
    for (const auto& [name, on] : ports)
      if (on) list.push_back(name);
    return list;
  }
  const ExactModel& model_;
  const circuit::HiddenParts& hidden_;
  std::map<std::string, bool> closed_, conducting_;
};

std::string listed(const std::vector<std::string>& events) { return fmt::format("{}", fmt::join(events, ", ")); }

/// V or A that the direction adds to the store.
double added(const ExactModel& model, const steady::Vector& direction, std::size_t island, const std::string& name) {
  const engine::IslandModel& part = model.islands[island];
  const model::StoreValues stores(part.island, part.extraction);
  steady::Vector x = steady::Vector::Zero(part.extraction.system.size());
  const steady::Stacking stacking(model);
  x.head(stacking.count(island)) = direction.segment(stacking.first(island), stacking.count(island));
  const steady::Vector values = stores.values(x);
  const auto at = std::find(stores.names().begin(), stores.names().end(), name) - stores.names().begin();
  return at < values.size() ? values[at] : 0.0;
}

}  // namespace

std::vector<NamedState> states_after_start(const ExactModel& model, const steady::Trace& trace) {
  std::vector<NamedState> states;
  if (trace.steps.empty()) return states;
  for (const engine::Change& change : trace.steps.front().changes) {
    const engine::IslandModel& island = model.islands[change.island];
    if (island.extraction.system.n == 0) continue;
    const model::StoreValues stores(island.island, island.extraction);
    steady::Vector x(island.extraction.system.size());
    model::from_mode(island.extraction.system, *change.after, change.y_after.data(), x.data());
    const steady::Vector values = stores.values(x);
    for (std::size_t k = 0; k < stores.names().size(); ++k)
      states.push_back({stores.names()[k], unit_of_store(stores.names()[k]), values[static_cast<Eigen::Index>(k)]});
  }
  return states;
}

std::vector<OrbitMode> orbit_modes(const ExactModel& model, const circuit::HiddenParts& hidden, const steady::Trace& trace, double period) {
  std::vector<OrbitMode> modes;
  Positions positions(model, hidden);
  for (const steady::TraceStep& step : trace.steps) {
    std::vector<std::string> events;
    for (const engine::Change& change : step.changes)
      for (std::string& event : positions.take(change)) events.push_back(std::move(event));
    const bool is_start = modes.empty();
    if (events.empty() && !step.has_jump && !is_start) continue;
    modes.push_back({step.time, positions.closed(), positions.conducting(), is_start ? "" : listed(events), step.has_jump});
  }
  // What happens at t = 0 is a change from the period's end.
  std::vector<std::string> events;
  if (!trace.steps.empty())
    for (const engine::Change& change : trace.steps.front().changes)
      for (std::string& event : positions.take(change)) events.push_back(std::move(event));
  if (!modes.empty()) modes.front().event = listed(events);
  constexpr double at_end = 1.0 - 1e-12;
  if (modes.size() > 1 && modes.back().time >= at_end * period) {
    modes.front().event = modes.back().event;
    modes.front().has_jump |= modes.back().has_jump;
    modes.pop_back();
  }
  return modes;
}

std::string coordinate_name(const ExactModel& model, std::size_t coordinate) {
  const auto [island, number] = place_of(model, coordinate);
  return model::StoreValues(model.islands[island].island, model.islands[island].extraction).of_coordinate(number);
}

std::string guard_name(const ExactModel& model, std::size_t island, int row) {
  const model::System& system = model.islands[island].extraction.system;
  if (row < system.diodes) return system.port[static_cast<std::size_t>(row)].name;
  const model::Control& control = system.controls[static_cast<std::size_t>(row - system.diodes) / 2];
  return model.switches[static_cast<std::size_t>(control.driven)].name;
}

NamedState largest_change(const ExactModel& model, const steady::Vector& direction) {
  Eigen::Index most = 0;
  direction.cwiseAbs().maxCoeff(&most);
  const auto [island, number] = place_of(model, static_cast<std::size_t>(most));
  const model::Network& network = model.islands[island].island.network;
  const std::string name = coordinate_name(model, static_cast<std::size_t>(most));
  const double value = added(model, direction, island, name);
  for (const model::Capacitor& c : network.capacitors)
    if (name == fmt::format("v({})", c.label.name)) return {c.label.name, "C", c.capacitance * value};
  for (const model::Inductor& l : network.inductors)
    if (name == fmt::format("i({})", l.label.name)) return {l.label.name, "Vs", l.inductance * value};
  return {name, unit_of_store(name), value};
}

std::vector<std::pair<std::string, double>> shares_of(const ExactModel& model, const Eigen::VectorXcd& direction) {
  return shares_by_name(direction, [&](std::size_t coordinate) { return coordinate_name(model, coordinate); });
}

std::vector<std::pair<std::string, double>> shares_by_name(const Eigen::VectorXcd& direction,
                                                           const std::function<std::string(std::size_t)>& name_of) {
  constexpr double least = 1e-6;
  std::map<std::string, double> share;
  const double whole = direction.squaredNorm();
  for (Eigen::Index k = 0; k < direction.size(); ++k)
    if (const double part = std::norm(direction[k]) / whole; part > least) share[name_of(static_cast<std::size_t>(k))] += part;
  std::vector<std::pair<std::string, double>> list(share.begin(), share.end());
  std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  return list;
}

}  // namespace pwlsim::analysis
