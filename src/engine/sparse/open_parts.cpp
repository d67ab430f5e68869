#include "engine/sparse/open_parts.hpp"

namespace pwlsim::engine::sparse {

OpenParts::OpenParts(const model::Network& network)
    : parts_(network.nodes.size()), loops_(network.nodes.size()), wired_(network.nodes.size()) {
  for (const auto& r : network.resistors) {
    parts_.join(r.p, r.n);
    if (r.resistance == 0.0) wired_.join(r.p, r.n);
  }
  for (const auto& c : network.capacitors) parts_.join(c.p, c.n);
  for (const auto& l : network.inductors) parts_.join(l.p, l.n);
  for (const auto& b : network.branches) {
    parts_.join(b.p, b.n);
    if (!model::is_independent(b.voltage)) continue;
    loops_.join(b.p, b.n);
    wired_.join(b.p, b.n);
  }
  const Windings windings(network);
  for (int i = 0; i < static_cast<int>(network.inductors.size()); ++i) tells_all_ &= windings.inductance(i) != 0.0;
  int index = 0;
  for (const auto& d : network.diodes) ports_.push_back({d.p, d.n, index++, d.resistance == 0.0});
  index += static_cast<int>(network.complementarities.size());
  for (const auto& s : network.switches) ports_.push_back({s.p, s.n, index++, s.resistance == 0.0});
}

std::vector<int> OpenParts::ties(const Position& on) const {
  std::vector<int> result;
  NodeSets parts = parts_, loops = loops_;
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
  NodeSets sets = wired_;
  int count = 0;
  for (const PortLink& port : ports_)
    if (on[static_cast<std::size_t>(port.index)] != 0 && port.is_short && !sets.join(port.p, port.n)) ++count;
  return count;
}

}  // namespace pwlsim::engine::sparse
