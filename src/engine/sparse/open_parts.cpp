#include "engine/sparse/open_parts.hpp"

#include <cmath>

#include "base/disjoint_sets.hpp"

namespace pwlsim::engine::sparse {

namespace {

/// Nodes that are one, ground among them as −1.
class NodeSets {
 public:
  explicit NodeSets(std::size_t nodes) : sets_(static_cast<int>(nodes) + 1) {}
  /// False: they were one already.
  bool join(model::NodeIndex a, model::NodeIndex b) { return sets_.join(a + 1, b + 1); }

 private:
  static_assert(model::ground == -1);
  DisjointSets sets_;
};

}  // namespace

OpenParts::OpenParts(const model::Network& network) : nodes_(network.nodes.size()) {
  for (const auto& r : network.resistors) {
    solid_.push_back({r.p, r.n});
    if (r.resistance == 0.0) wires_.push_back({r.p, r.n});
  }
  for (const auto& c : network.capacitors) solid_.push_back({c.p, c.n});
  for (const auto& l : network.inductors) solid_.push_back({l.p, l.n});
  for (const auto& b : network.branches) (model::is_independent(b.voltage) ? shorts_ : solid_).push_back({b.p, b.n});
  const Windings windings(network);
  for (int i = 0; i < static_cast<int>(network.inductors.size()); ++i) tells_all_ &= windings.inductance(i) != 0.0;
  int index = 0;
  for (const auto& d : network.diodes) ports_.push_back({{d.p, d.n}, index++, d.resistance == 0.0});
  index += static_cast<int>(network.complementarities.size());
  for (const auto& s : network.switches) ports_.push_back({{s.p, s.n}, index++, s.resistance == 0.0});
}

std::vector<int> OpenParts::ties(const Position& on) const {
  std::vector<int> result;
  NodeSets parts(nodes_), loops(nodes_);
  for (const Link& link : solid_) parts.join(link.p, link.n);
  for (const Link& link : shorts_) {
    parts.join(link.p, link.n);
    loops.join(link.p, link.n);
  }
  for (const PortLink& port : ports_) {
    if (on[static_cast<std::size_t>(port.index)] == 0) continue;
    parts.join(port.p, port.n);
    if (port.is_short && !loops.join(port.p, port.n)) result.push_back(port.index);
  }
  for (const PortLink& port : ports_)
    if (on[static_cast<std::size_t>(port.index)] == 0 && parts.join(port.p, port.n)) result.push_back(port.index);
  return result;
}

int OpenParts::loops(const Position& on) const {
  NodeSets sets(nodes_);
  for (const auto* links : {&shorts_, &wires_})
    for (const Link& link : *links) sets.join(link.p, link.n);
  int count = 0;
  for (const PortLink& port : ports_)
    if (on[static_cast<std::size_t>(port.index)] != 0 && port.is_short && !sets.join(port.p, port.n)) ++count;
  return count;
}

}  // namespace pwlsim::engine::sparse
