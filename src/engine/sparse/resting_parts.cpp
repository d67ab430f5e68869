#include "engine/sparse/resting_parts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

constexpr int nowhere = -1;

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
    edges_.push_back({injection.p + 1, injection.n + 1, false, true, -1, {}, {}, !model::is_independent(injection.current), true});
  add_ports();
}

void RestingParts::add_ports() {
  for (std::size_t i = 0; i < descriptor_.ports().size(); ++i) {
    const DescriptorPort& port = descriptor_.ports()[i];
    const bool is_ideal =
        std::all_of(port.slack.z.begin(), port.slack.z.end(), [&](const auto& part) { return part.index < descriptor_.nodes(); });
    const bool has_drop = port.slack.constant != 0.0 || !port.slack.w.empty();
    const bool is_input = port.p == port.n;  // of a complementarity, which is no current between nodes
    edges_.push_back({port.p + 1, port.n + 1, is_ideal, has_drop, static_cast<int>(i), {port.row}, {}, is_input});
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
  const bool is_known = is_divided_ && divided_on_ == on && has_sources_ == start.has_sources;
  on_ = &on;
  has_sources_ = start.has_sources;
  const auto& states = descriptor_.states();
  bool has_empty = false, has_current = false;
  for (std::size_t i = 0; i < states.size(); ++i) {
    holds_[i] = weights[i] * std::abs(states[i].value(start.z.data())) > tolerance::at_rest * size ? 1 : 0;
    has_empty |= holds_[i] == 0;
    has_current |= states[i].is_current && holds_[i] != 0;
  }
  rests_.assign(edges_.size(), 0);
  const bool has_resting_blocks = has_empty || (has_current && cuts_current());
  if (!is_known && has_resting_blocks) divide(on);
  has_blocks_ = is_known || has_resting_blocks;
  if (has_resting_blocks) find_blocks(start);
  take_out_ends(start);
}

void RestingParts::divide(const Position& on) {
  is_divided_ = true;
  divided_on_ = on;
  merge();
  find_conducting();
  blocks_ = blocks_of(static_cast<int>(at_.size()), ends_);
}

/// Whether an inductor that carries a current is a block alone. All else that conducts makes one node of what it joins, which leaves blocks of one edge as they are, and few edges.
bool RestingParts::cuts_current() const {
  const auto& states = descriptor_.states();
  DisjointSets joined(static_cast<int>(at_.size()));
  std::vector<std::pair<int, int>> ends;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const Edge& edge = edges_[i];
    if (i < states.size() && states[i].is_current && holds_[i] != 0)
      ends.emplace_back(edge.a, edge.b);
    else if (conducts(edge))
      joined.join(edge.a, edge.b);
  }
  std::vector<int> number(at_.size(), nowhere);
  int count = 0;
  const auto number_of = [&](int node) {
    int& of_set = number[static_cast<std::size_t>(joined.find(node))];
    if (of_set == nowhere) of_set = count++;
    return of_set;
  };
  for (auto& [a, b] : ends) {
    a = number_of(a);
    b = number_of(b);
  }
  const Blocks blocks = blocks_of(count, ends);
  return std::any_of(blocks.list.begin(), blocks.list.end(), is_alone);
}

/// Nodes that are one.
void RestingParts::merge() {
  const auto count = static_cast<int>(at_.size());
  merged_ = DisjointSets(count);
  for (const int i : wires_) {
    const Edge& edge = edges_[static_cast<std::size_t>(i)];
    if (conducts(edge) && is_wire(edge)) merged_.join(edge.a, edge.b);
  }
  members_.assign(at_.size(), {});
  for (int node = 0; node < count; ++node) members_[static_cast<std::size_t>(merged_.find(node))].push_back(node);
}

/// Edges between sets.
void RestingParts::find_conducting() {
  conducting_.clear();
  ends_.clear();
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const Edge& edge = edges_[i];
    const int a = merged_.find(edge.a), b = merged_.find(edge.b);
    if (!conducts(edge) || (is_wire(edge) && a == b)) continue;
    conducting_.push_back(static_cast<int>(i));
    ends_.emplace_back(a, b);
  }
}

const std::vector<char>& RestingParts::idle_ports(const Position& on) {
  on_ = &on;
  has_sources_ = true;
  is_divided_ = false;
  merged_ = DisjointSets(static_cast<int>(at_.size()));
  find_conducting();
  idle_.assign(on.size(), 0);
  const auto edge_of = [&](int e) -> const Edge& { return edges_[static_cast<std::size_t>(conducting_[static_cast<std::size_t>(e)])]; };
  const Blocks blocks = blocks_of(static_cast<int>(at_.size()), ends_);
  for (const Block& block : blocks.list) {
    const std::span<const int> edges = blocks.edges_of(block);
    if (!is_alone(block) && !std::all_of(edges.begin(), edges.end(), [&](int e) { return is_wire(edge_of(e)); })) continue;
    for (const int e : edges)
      if (const int port = edge_of(e).port; port >= 0) idle_[static_cast<std::size_t>(port)] = 1;
  }
  return idle_;
}

void RestingParts::find_blocks(const Origin& start) {
  charged_.assign(at_.size(), 0);
  for (int node = 1; node < static_cast<int>(at_.size()); ++node)
    if (start.has_more(node - 1)) charged_[static_cast<std::size_t>(merged_.find(node))] = 1;
  std::vector<char> moving(blocks_.list.size(), 0);
  for (std::size_t b = 0; b < moving.size(); ++b)
    for (const int e : blocks_.edges_of(blocks_.list[b]))
      if (moves(static_cast<std::size_t>(conducting_[static_cast<std::size_t>(e)]), start)) moving[b] = 1;
  spread(moving);
  anchor_.assign(at_.size(), nowhere);
  for (std::size_t b = 0; b < moving.size(); ++b) {
    const Block& block = blocks_.list[b];
    for (const int e : blocks_.edges_of(block)) {
      const auto i = static_cast<std::size_t>(conducting_[static_cast<std::size_t>(e)]);
      if (moving[b] == 0 || (is_alone(block) && edges_[i].is_free() && !is_pushed(i, start))) rest(i);
    }
    moving[b] == 0 ? rest_nodes(block) : follow_nodes(block);
  }
}

bool RestingParts::has_more_current(const Edge& edge, const Origin& start) {
  return std::any_of(edge.currents.begin(), edge.currents.end(), [&](int current) { return start.has_more(current); });
}

/// Whether impulses or charges beside the unknowns reach an edge.
bool RestingParts::is_pushed(std::size_t edge, const Origin& start) {
  const Edge& at = edges_[edge];
  for (const int node : {at.a, at.b})
    if (charged_[static_cast<std::size_t>(merged_.find(node))] != 0) return true;
  return has_more_current(at, start);
}

bool RestingParts::moves(std::size_t edge, const Origin& start) {
  const Edge& at = edges_[edge];
  return (edge < descriptor_.states().size() && holds_[edge] != 0) || is_source(at) || at.is_controlled || is_pushed(edge, start);
}

/// What moves moves the inductors that are coupled to it.
void RestingParts::spread(std::vector<char>& moving) {
  std::vector<std::size_t> block_of(edges_.size(), 0), open;
  for (std::size_t b = 0; b < moving.size(); ++b) {
    for (const int e : blocks_.edges_of(blocks_.list[b])) block_of[static_cast<std::size_t>(conducting_[static_cast<std::size_t>(e)])] = b;
    if (moving[b] != 0) open.push_back(b);
  }
  while (!open.empty()) {
    const std::size_t b = open.back();
    open.pop_back();
    for (const int e : blocks_.edges_of(blocks_.list[b]))
      for (const int other : edges_[static_cast<std::size_t>(conducting_[static_cast<std::size_t>(e)])].coupled) {
        const std::size_t next = block_of[static_cast<std::size_t>(other)];
        if (std::exchange(moving[next], 1) == 0) open.push_back(next);
      }
  }
}

void RestingParts::rest(std::size_t edge) {
  rests_[edge] = 1;
  const std::vector<int>& currents = edges_[edge].currents;
  currents_.insert(currents_.end(), currents.begin(), currents.end());
}

/// Nodes of a block that rests are at the voltage of the one that it hangs on.
void RestingParts::rest_nodes(const Block& block) {
  for (const int set : sets_of(block)) {
    anchor_[static_cast<std::size_t>(set)] = static_cast<int>(nodes_.size());
    for (const int node : members_[static_cast<std::size_t>(set)]) nodes_.push_back({node - 1, block.hangs_on - 1});
  }
}

/// Nodes of a block that moves go with the one that it hangs on.
void RestingParts::follow_nodes(const Block& block) {
  const int anchor = anchor_[static_cast<std::size_t>(block.hangs_on)];
  if (anchor == nowhere) return;
  for (const int set : sets_of(block)) {
    anchor_[static_cast<std::size_t>(set)] = anchor;
    for (const int node : members_[static_cast<std::size_t>(set)]) nodes_[static_cast<std::size_t>(anchor)].followers.push_back(node - 1);
  }
}

/// Without the one that it hangs on.
const std::vector<int>& RestingParts::sets_of(const Block& block) {
  open_.clear();
  for (const int e : blocks_.edges_of(block))
    for (const int set : {ends_[static_cast<std::size_t>(e)].first, ends_[static_cast<std::size_t>(e)].second})
      if (set != block.hangs_on) open_.push_back(set);
  std::sort(open_.begin(), open_.end());
  open_.erase(std::unique(open_.begin(), open_.end()), open_.end());
  return open_;
}

/// An element at a node where nothing else moves carries nothing, whatever is stored.
void RestingParts::take_out_ends(const Origin& start) {
  std::vector<std::pair<int, int>> ends;
  open_.resize(at_.size() - 1);
  std::iota(open_.begin(), open_.end(), 1);
  while (!open_.empty()) {
    const int node = open_.back();
    open_.pop_back();
    int last = nowhere, moving = 0;
    for (const int i : at_[static_cast<std::size_t>(node)])
      if (rests_[static_cast<std::size_t>(i)] == 0 && conducts(edges_[static_cast<std::size_t>(i)])) {
        last = i;
        ++moving;
      }
    if (node == 0 || moving != 1 || start.has_more(node - 1)) continue;
    const auto i = static_cast<std::size_t>(last);
    const Edge& edge = edges_[i];
    if (edge.a == edge.b || !edge.is_free() || has_more_current(edge, start)) continue;
    rest(i);
    const int other = edge.a == node ? edge.b : edge.a;
    if (i >= descriptor_.states().size() && !is_source(edge) && !edge.is_controlled) ends.emplace_back(node, other);
    open_.push_back(other);
  }
  for (auto end = ends.rbegin(); end != ends.rend(); ++end) nodes_.push_back({end->first - 1, end->second - 1});
}

void RestingParts::hold(std::vector<double>& z) const {
  for (const Held& held : nodes_) {
    const double value = held.at >= 0 ? z[static_cast<std::size_t>(held.at)] : 0.0,
                 before = std::exchange(z[static_cast<std::size_t>(held.node)], value);
    for (const int follower : held.followers) z[static_cast<std::size_t>(follower)] += value - before;
  }
  cut_off(z);
}

void RestingParts::cut_off(std::vector<double>& z) const {
  for (const int current : currents_) z[static_cast<std::size_t>(current)] = 0.0;
}

void RestingParts::add_impulses(const std::vector<double>& start, const std::vector<double>& stores, double factor,
                                std::vector<double>& z) {
  if (!has_blocks_) return;  // no inductor carried a current
  const std::size_t first = descriptor_.network().capacitors.size(), end = descriptor_.states().size();
  std::vector<double> lift(at_.size(), 0.0);  // of sets; a block comes after the one that it hangs on
  for (const Block& block : blocks_.list) {
    const auto e = static_cast<std::size_t>(conducting_[static_cast<std::size_t>(blocks_.edges_of(block).front())]);
    double more = lift[static_cast<std::size_t>(block.hangs_on)];
    if (is_alone(block) && rests_[e] != 0 && e >= first && e < end) {
      const auto current = static_cast<std::size_t>(edges_[e].currents.front());
      const double impulse = -factor * stores[current] * start[current];
      more += merged_.find(edges_[e].a) == block.hangs_on ? -impulse : impulse;
    }
    for (const int set : sets_of(block)) lift[static_cast<std::size_t>(set)] = more;
  }
  for (int node = 1; node < static_cast<int>(at_.size()); ++node)
    z[static_cast<std::size_t>(node) - 1] += lift[static_cast<std::size_t>(merged_.find(node))];
}

}  // namespace pwlsim::engine::sparse
