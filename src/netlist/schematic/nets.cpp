#include "netlist/schematic/nets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/names.hpp"

namespace pwlsim::netlist {

namespace {

GridPoint exchanged(GridPoint point) { return {point.y, point.x}; }

}  // namespace

bool lies_on(GridPoint point, const Wire& wire) {
  const auto between = [](std::int32_t x, std::int32_t a, std::int32_t b) { return std::min(a, b) <= x && x <= std::max(a, b); };
  if (!between(point.x, wire.from.x, wire.to.x) || !between(point.y, wire.from.y, wire.to.y)) return false;
  const std::int64_t along_x = wire.to.x - wire.from.x, along_y = wire.to.y - wire.from.y;
  return along_x * (point.y - wire.from.y) == along_y * (point.x - wire.from.x);
}

std::string node_name(std::string_view label) {
  std::string name(label);
  for (char& c : name)
    if (std::string_view(" \t(){}=,\"';").find(c) != std::string_view::npos) c = '_';
  return name;
}

Nets::Nets(const Sheet& sheet, const std::vector<GridPoint>& pins, const std::vector<Wire>& joined) {
  for (const Wire& wire : sheet.wires) {
    add_point(wire.from);
    add_point(wire.to);
  }
  for (const Flag& flag : sheet.flags) add_point(flag.at);
  for (const GridPoint pin : pins) add_point(pin);
  sets_ = DisjointSets(static_cast<int>(points_.size()));
  for (const Wire& wire : sheet.wires) join_along(wire);
  for (const Wire& wire : joined) join(wire.from, wire.to);
  join_labels(sheet.flags);
  name_labelled(sheet.flags);
  name_others();
}

void Nets::add_point(GridPoint point) {
  uses_[point] += 1;
  const auto index = static_cast<Index>(points_.size());
  if (points_.emplace(point, index).second) by_rows_.emplace(exchanged(point), index);
}

/// Only the points between the ends of the wire are looked at: those of its row, or of its columns.
void Nets::join_along(const Wire& wire) {
  const bool is_level = wire.to.y == wire.from.y;
  const auto& order = is_level ? by_rows_ : points_;
  const auto key = [&](GridPoint point) { return is_level ? exchanged(point) : point; };
  const auto [low, high] = std::minmax({key(wire.from), key(wire.to)});  // of values, as they are temporary
  for (auto at = order.lower_bound(low); at != order.end() && at->first <= high; ++at)
    if (lies_on(key(at->first), wire)) {
      join(wire.from, key(at->first));
      uses_[key(at->first)] += 1;
    }
}

void Nets::join_labels(const std::vector<Flag>& flags) {
  std::map<std::string, GridPoint> first;
  for (const Flag& flag : flags) {
    const std::string key = is_ground_name(flag.name) ? "0" : without_case(node_name(flag.name));
    const auto [known, is_new] = first.emplace(key, flag.at);
    if (!is_new) join(known->second, flag.at);
  }
}

void Nets::name_labelled(const std::vector<Flag>& flags) {
  for (const Flag& flag : flags)
    if (is_ground_name(flag.name)) names_[root(flag.at)] = "0";
  std::set<std::string> told;
  for (const Flag& flag : flags) {
    const std::string label = node_name(flag.name);
    const auto [named, is_new] = names_.emplace(root(flag.at), label);
    if (!is_new && !is_ground_name(label) && !same_name(named->second, label) && told.insert(without_case(label)).second)
      aliases_.push_back({label, named->second});
  }
}

void Nets::name_others() {
  std::set<std::string> taken;
  for (const auto& [index, name] : names_) taken.insert(without_case(name));
  for (const Alias& alias : aliases_) taken.insert(without_case(alias.label));
  int number = 0;
  for (const auto& [point, index] : by_rows_) {
    std::string& name = names_[sets_.find(index)];
    while (name.empty()) {
      std::string next = fmt::format("N{:03}", ++number);
      if (!taken.contains(without_case(next))) name = std::move(next);
    }
  }
}

const std::string& Nets::name_at(GridPoint pin) const { return names_.at(root(pin)); }

bool Nets::is_open(GridPoint pin) const { return uses_.at(pin) == 1; }

}  // namespace pwlsim::netlist
