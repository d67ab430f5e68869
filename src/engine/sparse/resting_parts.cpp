#include "engine/sparse/resting_parts.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

constexpr int nowhere = -1, several = -2;  ///< nodes that a part hangs on

}  // namespace

RestingParts::RestingParts(const Descriptor& descriptor)
    : descriptor_(descriptor), at_(static_cast<std::size_t>(descriptor.nodes()) + 1), merged_(0) {
  const model::Network& network = descriptor.network();
  const model::Unknowns& unknowns = descriptor.unknowns();
  const auto currents_of = [](int unknown) { return unknown >= 0 ? std::vector<int>{unknown} : std::vector<int>{}; };
  for (std::size_t i = 0; i < network.capacitors.size(); ++i) {
    const auto& c = network.capacitors[i];
    edges_.push_back({c.p + 1, c.n + 1, false, false, -1, currents_of(unknowns.capacitor(i))});
  }
  const int first_inductor = static_cast<int>(edges_.size());
  for (std::size_t i = 0; i < network.inductors.size(); ++i) {
    const auto& l = network.inductors[i];
    edges_.push_back({l.p + 1, l.n + 1, false, false, -1, {unknowns.inductor(static_cast<int>(i))}});
  }
  for (const auto& k : network.couplings) {
    const int a = first_inductor + k.inductor_a, b = first_inductor + k.inductor_b;
    edges_[static_cast<std::size_t>(a)].coupled.push_back(b);
    edges_[static_cast<std::size_t>(b)].coupled.push_back(a);
  }
  for (std::size_t i = 0; i < network.resistors.size(); ++i) {
    const auto& r = network.resistors[i];
    edges_.push_back({r.p + 1, r.n + 1, r.resistance == 0.0, false, -1, currents_of(unknowns.low_resistor(i))});
  }
  for (std::size_t i = 0; i < network.branches.size(); ++i) {
    const auto& b = network.branches[i];
    const bool is_source = std::any_of(b.voltage.begin(), b.voltage.end(), [](const auto& term) { return model::is_independent(term); });
    const std::vector<int> current{unknowns.branch(static_cast<int>(i))};
    edges_.push_back({b.p + 1, b.n + 1, b.voltage.empty(), is_source, -1, current, {}, !model::is_independent(b.voltage)});
  }
  for (const auto& injection : network.injections)
    edges_.push_back({injection.p + 1, injection.n + 1, false, true, -1, {}, {}, !model::is_independent(injection.current)});
  add_ports();
}

void RestingParts::add_ports() {
  for (std::size_t i = 0; i < descriptor_.ports().size(); ++i) {
    const DescriptorPort& port = descriptor_.ports()[i];
    const bool is_ideal =
        std::all_of(port.slack.z.begin(), port.slack.z.end(), [&](const auto& part) { return part.index < descriptor_.nodes(); });
    const bool has_drop = port.slack.constant != 0.0 || !port.slack.w.empty();
    edges_.push_back({port.p + 1, port.n + 1, is_ideal, has_drop, static_cast<int>(i), {port.row}});
  }
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const Edge& edge = edges_[i];
    if (edge.is_wire) wires_.push_back(static_cast<int>(i));
    at_[static_cast<std::size_t>(edge.a)].push_back(static_cast<int>(i));
    if (edge.b != edge.a) at_[static_cast<std::size_t>(edge.b)].push_back(static_cast<int>(i));
  }
  holds_.resize(edges_.size());
}

void RestingParts::find(const Position& on, const Origin& start, const std::vector<double>& weights, double size) {
  nodes_.clear();
  currents_.clear();
  on_ = &on;
  has_sources_ = start.has_sources;
  const auto& states = descriptor_.states();
  bool any = false;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const bool is_empty = weights[i] * std::abs(states[i].value(start.z.data())) <= tolerance::at_rest * size;
    holds_[i] = is_empty ? 0 : 1;
    any |= is_empty;
  }
  if (!any || !merge(start)) return;
  part_ = 0;
  seen_.assign(edges_.size(), 0);
  rests_.assign(edges_.size(), 0);
  for (std::size_t i = 0; i < states.size(); ++i)
    if (holds_[i] == 0 && seen_[i] == 0 && rests(static_cast<int>(i), start)) add_part();
  if (!nodes_.empty() || !currents_.empty()) take_out_ends();
}

/// Nodes that are one. False: none are.
bool RestingParts::merge(const Origin& start) {
  const auto count = at_.size();
  merged_ = DisjointSets(static_cast<int>(count));
  bool any = false;
  for (const int i : wires_) {
    const Edge& edge = edges_[static_cast<std::size_t>(i)];
    any |= conducts(edge) && is_wire(edge) && merged_.join(edge.a, edge.b);
  }
  if (!any) return false;
  shared_.assign(count, 0);
  charged_.assign(count, 0);
  shared_[0] = 1;
  for (int node = 1; node < static_cast<int>(count); ++node) {
    const auto set = static_cast<std::size_t>(merged_.find(node));
    if (static_cast<int>(set) != node) shared_[set] = 1;
    if (!start.more.empty() && start.more[static_cast<std::size_t>(node - 1)] != 0.0) charged_[set] = 1;
  }
  return true;
}

/// False: it has been seen in a part that is not at rest, which this is then.
bool RestingParts::enter(int edge) {
  int& seen = seen_[static_cast<std::size_t>(edge)];
  if (seen == 0) {
    part_edges_.push_back(edge);
    seen = part_;
  }
  return seen == part_;
}

/// Whether the part of the network that a store is in is at rest: it is what can be reached from there without passing a node that hangs others.
bool RestingParts::rests(int edge, const Origin& start) {
  part_edges_.clear();
  part_nodes_.clear();
  part_hangs_on_ = nowhere;
  ++part_;
  bool moves = !enter(edge);
  for (std::size_t k = 0; k < part_edges_.size(); ++k) {
    const auto i = static_cast<std::size_t>(part_edges_[k]);
    const Edge& at = edges_[i];
    moves |= (i < descriptor_.states().size() && holds_[i] != 0) || is_source(at) || at.is_controlled;
    if (!start.more.empty())
      for (const int current : at.currents) moves |= start.more[static_cast<std::size_t>(current)] != 0.0;
    for (const int other : at.coupled) moves |= !enter(other);
    for (const int node : {at.a, at.b}) {
      const int set = merged_.find(node);
      moves |= charged_[static_cast<std::size_t>(set)] != 0;
      if (shared_[static_cast<std::size_t>(set)] != 0) {
        part_hangs_on_ = part_hangs_on_ == nowhere || part_hangs_on_ == set ? set : several;
        continue;
      }
      part_nodes_.push_back(node);
      for (const int next : at_[static_cast<std::size_t>(node)])
        if (conducts(edges_[static_cast<std::size_t>(next)])) moves |= !enter(next);
    }
    if (moves || part_hangs_on_ == several) return false;
  }
  return part_hangs_on_ >= 0;
}

/// The one just found.
void RestingParts::add_part() {
  for (const int node : part_nodes_) nodes_.emplace_back(node - 1, part_hangs_on_ - 1);
  for (const int i : part_edges_) {
    rests_[static_cast<std::size_t>(i)] = 1;
    const std::vector<int>& currents = edges_[static_cast<std::size_t>(i)].currents;
    currents_.insert(currents_.end(), currents.begin(), currents.end());
  }
}

/// A wire at a node where nothing else moves carries nothing.
void RestingParts::take_out_ends() {
  std::vector<int> ends;
  for (int node = 1; node < static_cast<int>(at_.size()); ++node) ends.push_back(node);
  while (!ends.empty()) {
    const int node = ends.back();
    ends.pop_back();
    int wire = nowhere, moving = 0;
    for (const int i : at_[static_cast<std::size_t>(node)])
      if (rests_[static_cast<std::size_t>(i)] == 0 && conducts(edges_[static_cast<std::size_t>(i)])) {
        wire = i;
        ++moving;
      }
    if (node == 0 || moving != 1) continue;
    const Edge& edge = edges_[static_cast<std::size_t>(wire)];
    if (!is_wire(edge) || edge.a == edge.b) continue;
    rests_[static_cast<std::size_t>(wire)] = 1;
    currents_.insert(currents_.end(), edge.currents.begin(), edge.currents.end());
    ends.push_back(edge.a == node ? edge.b : edge.a);
  }
}

void RestingParts::hold(std::vector<double>& z) const {
  for (const auto& [node, at] : nodes_) z[static_cast<std::size_t>(node)] = at >= 0 ? z[static_cast<std::size_t>(at)] : 0.0;
  for (const int current : currents_) z[static_cast<std::size_t>(current)] = 0.0;
}

}  // namespace pwlsim::engine::sparse
