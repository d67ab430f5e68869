#include "engine/sparse/open_parts.hpp"

#include <cmath>
#include <numeric>

namespace pwlsim::engine::sparse {

namespace {

constexpr double perfect_coupling = 1.0 - 1e-9;

/// Disjoint sets of nodes, ground the last.
class Sets {
 public:
  explicit Sets(std::size_t nodes) : parent_(nodes + 1) { std::iota(parent_.begin(), parent_.end(), 0U); }
  /// False: they were one already.
  bool join(model::NodeIndex a, model::NodeIndex b) {
    const std::size_t x = root(a), y = root(b);
    if (x == y) return false;
    parent_[x] = y;
    return true;
  }

 private:
  std::size_t root(model::NodeIndex node) {
    std::size_t i = node == model::ground ? parent_.size() - 1 : static_cast<std::size_t>(node);
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  std::vector<std::size_t> parent_;
};

}  // namespace

OpenParts::OpenParts(const model::Network& network) : nodes_(network.nodes.size()) {
  for (const auto& r : network.resistors) solid_.push_back({r.p, r.n});
  for (const auto& c : network.capacitors) solid_.push_back({c.p, c.n});
  for (const auto& l : network.inductors) solid_.push_back({l.p, l.n});
  for (const auto& b : network.branches) (model::is_independent(b.voltage) ? shorts_ : solid_).push_back({b.p, b.n});
  for (const auto& k : network.couplings) tells_all_ &= std::abs(k.coefficient) < perfect_coupling;
  int index = 0;
  for (const auto& d : network.diodes) ports_.push_back({{d.p, d.n}, index++, d.resistance == 0.0});
  index += static_cast<int>(network.complementarities.size());
  for (const auto& s : network.switches) ports_.push_back({{s.p, s.n}, index++, s.resistance == 0.0});
}

std::vector<int> OpenParts::ties(const Position& on) const {
  std::vector<int> result;
  Sets parts(nodes_), loops(nodes_);
  for (const Link& link : solid_) parts.join(link.p, link.n);
  for (const Link& link : shorts_) {
    parts.join(link.p, link.n);
    loops.join(link.p, link.n);
  }
  for (const Port& port : ports_) {
    if (on[static_cast<std::size_t>(port.index)] == 0) continue;
    parts.join(port.p, port.n);
    if (port.is_short && !loops.join(port.p, port.n)) result.push_back(port.index);
  }
  for (const Port& port : ports_)
    if (on[static_cast<std::size_t>(port.index)] == 0 && parts.join(port.p, port.n)) result.push_back(port.index);
  return result;
}

}  // namespace pwlsim::engine::sparse
