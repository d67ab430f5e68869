#include "engine/sparse/gates.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <variant>

#include "model/builder.hpp"
#include "model/forms.hpp"

namespace pwlsim::engine::sparse {

namespace {

using model::ground;
using model::LinearForm;
using model::Network;
using model::Term;

/// A node's voltage: that of `root`, and on top of it a sum of sources.
struct Held {
  int root = ground;
  LinearForm above{};
};
using HeldNodes = std::unordered_map<int, Held>;

/// All nodes between which sources hold voltages, by themselves or one on the other: above ground, or above one of them that floats.
class Holding {
 public:
  explicit Holding(const Network& network) {
    for (const auto& condition : network.node_conditions) conditioned_.insert(condition.node);
    for (const auto& branch : network.branches) {
      if (!model::is_independent(branch.voltage)) continue;
      at_[branch.p].push_back(&branch);
      at_[branch.n].push_back(&branch);
    }
    spread(ground);
    for (const auto& branch : network.branches)
      if (model::is_independent(branch.voltage) && !conditioned_.contains(branch.p)) spread(branch.p);
  }
  [[nodiscard]] HeldNodes take() { return std::move(held_); }

 private:
  /// From a node on, where it is not held yet.
  void spread(int root) {
    if (!held_.try_emplace(root, Held{root}).second) return;
    std::vector<int> reached{root};
    while (!reached.empty()) {
      const int from = reached.back();
      reached.pop_back();
      for (const model::Branch* branch : at_[from]) {
        const int to = branch->p == from ? branch->n : branch->p;
        if (conditioned_.contains(to) || held_.contains(to)) continue;
        Held held = held_.at(from);
        model::accumulate(held.above, branch->voltage, branch->p == from ? -1.0 : 1.0);
        held_.emplace(to, std::move(held));
        reached.push_back(to);
      }
    }
  }

  std::unordered_set<int> conditioned_;
  std::unordered_map<int, std::vector<const model::Branch*>> at_;
  HeldNodes held_;
};

/// Terms of one quantity as one, without those that cancel.
LinearForm collected(const LinearForm& form) {
  LinearForm result;
  for (const Term& term : form) {
    const auto same =
        std::find_if(result.begin(), result.end(), [&](const Term& t) { return t.kind == term.kind && t.index == term.index; });
    if (same == result.end())
      result.push_back(term);
    else
      same->coefficient += term.coefficient;
  }
  std::erase_if(result, [](const Term& term) { return term.coefficient == 0.0; });
  return result;
}

/// The same form of sources and constants alone, where that is what it reads: of nodes that float, differences.
std::optional<LinearForm> by_sources(const LinearForm& form, const HeldNodes& held) {
  LinearForm result, roots;
  for (const Term& term : form) {
    if (model::is_independent(term)) {
      result.push_back(term);
      continue;
    }
    if (term.kind != Term::Kind::node_voltage) return std::nullopt;
    if (term.index == ground) continue;
    const auto found = held.find(term.index);
    if (found == held.end()) return std::nullopt;
    model::accumulate(result, found->second.above, term.coefficient);
    if (found->second.root != ground) roots.push_back({Term::Kind::node_voltage, found->second.root, term.coefficient});
  }
  if (!collected(roots).empty()) return std::nullopt;
  return collected(result);
}

std::shared_ptr<const model::Track> continuous_track(const model::SourceFunction& function) {
  std::optional<model::Track> track;
  if (const auto* pulse = std::get_if<model::Pulse>(&function)) track = model::make_track(*pulse);
  if (const auto* pwl = std::get_if<model::Pwl>(&function)) track = model::make_track(*pwl);
  if (const auto* dc = std::get_if<model::Dc>(&function)) {
    track.emplace();
    track->initial = dc->value;
  }
  return track && track->is_continuous() ? std::make_shared<const model::Track>(std::move(*track)) : nullptr;
}

std::optional<Gate> gate_of(std::size_t port, const model::Switch& s, const Network& network) {
  double constant = 0.0;
  std::vector<model::Clock::Term> terms;
  for (const Term& term : s.control) {
    if (term.kind == Term::Kind::one) {
      constant += term.coefficient;
      continue;
    }
    if (term.kind != Term::Kind::source) return std::nullopt;
    auto track = continuous_track(network.sources[static_cast<std::size_t>(term.index)].function);
    if (!track) return std::nullopt;
    terms.push_back({std::move(track), term.coefficient});
  }
  return Gate(port, s.inverted, {std::move(terms), constant, s.on_level, s.off_level, static_cast<int>(port), 0.0});
}

}  // namespace

void Gate::begin(bool closed, double stop) {
  stop_ = stop;
  clock_.start(closed != inverted_);
  skip_empty();
  while (next() <= 0.0) pass();
}

void Gate::pass() {
  clock_.take();
  skip_empty();
}

/// Passes the instants at which nothing changes sides.
void Gate::skip_empty() {
  while (clock_.next().time < stop_ && !clock_.next().flips) clock_.take();
}

Network with_controls_of_sources(Network network) {
  const HeldNodes held = Holding(network).take();
  for (auto& s : network.switches)
    if (auto form = by_sources(s.control, held)) s.control = std::move(*form);
  return network;
}

std::vector<Gate> take_gates(Network& network) {
  std::vector<Gate> gates;
  std::vector<char> read(network.sources.size(), 0);
  const auto note = [&](const LinearForm& form) {
    for (const Term& term : form)
      if (term.kind == Term::Kind::source) read[static_cast<std::size_t>(term.index)] = 1;
  };
  model::for_each_equation(network, note);
  for (const auto& s : network.signals) note(s.form);
  const std::size_t first = network.diodes.size() + network.complementarities.size();
  for (std::size_t i = 0; i < network.switches.size(); ++i) {
    auto gate = gate_of(first + i, network.switches[i], network);
    if (gate)
      gates.push_back(std::move(*gate));
    else
      note(network.switches[i].control);
  }
  for (std::size_t i = 0; i < read.size(); ++i) {
    auto& function = network.sources[i].function;
    if (read[i] != 0 || std::holds_alternative<model::Dc>(function)) continue;
    if (const auto track = continuous_track(function)) function = model::Dc{track->before(0.0).value};
  }
  return gates;
}

}  // namespace pwlsim::engine::sparse
