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

struct HeldVoltage {
  int p = ground, n = ground;
  const LinearForm* voltage = nullptr;
};

/// The voltage of every node that sources hold, by themselves or one on the other.
std::unordered_map<int, LinearForm> held_nodes(const Network& network) {
  std::vector<HeldVoltage> sources;
  for (const auto& b : network.branches)
    if (model::is_independent(b.voltage)) sources.push_back({b.p, b.n, &b.voltage});
  std::unordered_set<int> conditioned;
  for (const auto& condition : network.node_conditions) conditioned.insert(condition.node);
  std::unordered_map<int, LinearForm> held{{ground, {}}};
  const auto is_held = [&](int node) { return held.contains(node); };
  model::spread_voltages(sources, is_held, [&](const HeldVoltage& source, bool from_p) {
    const int node = from_p ? source.n : source.p;
    if (conditioned.contains(node)) return false;
    LinearForm voltage = held.at(from_p ? source.p : source.n);
    model::accumulate(voltage, *source.voltage, from_p ? -1.0 : 1.0);
    held.emplace(node, std::move(voltage));
    return true;
  });
  return held;
}

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

/// The same form of sources and constants alone, where that is what it reads.
std::optional<LinearForm> by_sources(const LinearForm& form, const std::unordered_map<int, LinearForm>& held) {
  LinearForm result;
  for (const Term& term : form) {
    if (model::is_independent(term)) {
      result.push_back(term);
      continue;
    }
    if (term.kind != Term::Kind::node_voltage) return std::nullopt;
    if (term.index == ground) continue;
    const auto found = held.find(term.index);
    if (found == held.end()) return std::nullopt;
    model::accumulate(result, found->second, term.coefficient);
  }
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
  const auto held = held_nodes(network);
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
