#include "analysis/segment_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace pwlsim::analysis {
namespace {

using engine::sparse::DescriptorPort;
using engine::sparse::PeriodMap;
using engine::sparse::Position;
using engine::sparse::SegmentRecord;

/// Which ports conduct, by name.
class SegmentPositions {
 public:
  explicit SegmentPositions(const circuit::HiddenParts& hidden) : hidden_(hidden) {}

  /// What changes, in words.
  void take(const std::vector<DescriptorPort>& ports, const Position& on, std::vector<std::string>& events) {
    for (std::size_t i = 0; i < ports.size(); ++i) {
      const DescriptorPort& port = ports[i];
      if (hidden_.hold(port.name)) continue;
      auto& list = port.is_switch ? closed_ : conducting_;
      const auto [known, is_new] = list.try_emplace(port.name, on[i] != 0);
      if (!is_new && known->second == (on[i] != 0)) continue;
      known->second = on[i] != 0;
      const char* what = port.is_switch ? (on[i] != 0 ? "closes" : "opens") : (on[i] != 0 ? "conducts" : "blocks");
      events.push_back(fmt::format("{} {}", port.name, what));
    }
  }
  [[nodiscard]] std::vector<std::string> closed() const { return names(closed_); }
  [[nodiscard]] std::vector<std::string> conducting() const { return names(conducting_); }

 private:
  static std::vector<std::string> names(const std::map<std::string, bool>& ports) {
    std::vector<std::string> list;
    for (const auto& [name, on] : ports)
      if (on) list.push_back(name);
    return list;
  }
  const circuit::HiddenParts& hidden_;
  std::map<std::string, bool> closed_, conducting_;
};

std::string listed_events(const std::vector<std::string>& events) { return fmt::format("{}", fmt::join(events, ", ")); }

}  // namespace

std::vector<NamedState> states_after_start(const PeriodMap& map) {
  std::vector<NamedState> states;
  const linalg::Vector values = map.values(map.energies(map.after_start()));
  for (std::size_t i = 0; i < map.stores().size(); ++i)
    states.push_back({map.stores()[i].name, map.stores()[i].unit, values[static_cast<Eigen::Index>(i)]});
  return states;
}

std::vector<OrbitMode> orbit_modes(const PeriodMap& map, const circuit::HiddenParts& hidden) {
  struct Place {
    std::size_t part;
    const SegmentRecord* record;
  };
  std::vector<Place> places;
  for (std::size_t part = 0; part < map.records().size(); ++part)
    for (const SegmentRecord& record : map.records()[part]) places.push_back({part, &record});
  std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.record->begin < b.record->begin; });
  const auto ports = [&](std::size_t part) -> const std::vector<DescriptorPort>& { return map.model().parts[part]->descriptor.ports(); };

  std::vector<OrbitMode> modes;
  SegmentPositions positions(hidden);
  for (auto place = places.begin(); place != places.end();) {
    const double time = place->record->begin;
    std::vector<std::string> events;
    bool has_jump = false;
    for (; place != places.end() && place->record->begin == time; ++place) {
      positions.take(ports(place->part), place->record->on, events);
      has_jump |= !place->record->jumps.empty();
    }
    const bool is_start = modes.empty();
    if (!is_start && events.empty() && !has_jump) continue;
    modes.push_back({time, positions.closed(), positions.conducting(), is_start ? "" : listed_events(events), has_jump});
  }
  // What happens at t = 0 is a change from the period's end.
  std::vector<std::string> events;
  for (std::size_t part = 0; part < map.records().size(); ++part)
    if (!map.records()[part].empty()) positions.take(ports(part), map.records()[part].front().on, events);
  if (!modes.empty()) modes.front().event = listed_events(events);
  return modes;
}

NamedState largest_change(const PeriodMap& map, const steady::Vector& direction) {
  Eigen::Index most = 0;
  direction.cwiseAbs().maxCoeff(&most);
  const PeriodMap::Store& store = map.stores()[static_cast<std::size_t>(most)];
  return {store.element, store.unit_of_content, store.storage * map.values(direction)[most]};
}

}  // namespace pwlsim::analysis
