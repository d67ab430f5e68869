#include "engine/sparse/gates.hpp"

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <utility>
#include <variant>

namespace pwlsim::engine::sparse {

namespace {

using model::ground;
using model::LinearForm;
using model::Network;
using model::Term;

/// The voltage of every node that a source to ground holds.
std::unordered_map<int, LinearForm> held_nodes(const Network& network) {
  std::unordered_map<int, LinearForm> held;
  for (const auto& b : network.branches) {
    if ((b.p == ground) == (b.n == ground) || !model::is_independent(b.voltage)) continue;
    LinearForm voltage = b.voltage;
    if (b.p == ground)
      for (Term& term : voltage) term.coefficient = -term.coefficient;
    held.emplace(b.p == ground ? b.n : b.p, std::move(voltage));
  }
  for (const auto& condition : network.node_conditions) held.erase(condition.node);
  return held;
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
    for (const Term& part : found->second) result.push_back({part.kind, part.index, term.coefficient * part.coefficient});
  }
  return result;
}

std::optional<model::Track> continuous_track(const model::SourceFunction& function) {
  std::optional<model::Track> track;
  if (const auto* pulse = std::get_if<model::Pulse>(&function)) track = model::make_track(*pulse);
  if (const auto* pwl = std::get_if<model::Pwl>(&function)) track = model::make_track(*pwl);
  if (const auto* dc = std::get_if<model::Dc>(&function)) {
    track.emplace();
    track->initial = dc->value;
  }
  return track && track->is_continuous() ? track : std::nullopt;
}

std::optional<Gate> gate_of(std::size_t port, const model::Switch& s, const Network& network) {
  double constant = 0.0;
  std::vector<Gate::Part> parts;
  for (const Term& term : s.control) {
    if (term.kind == Term::Kind::one) {
      constant += term.coefficient;
      continue;
    }
    if (term.kind != Term::Kind::source) return std::nullopt;
    auto track = continuous_track(network.sources[static_cast<std::size_t>(term.index)].function);
    if (!track) return std::nullopt;
    parts.push_back({std::move(*track), term.coefficient});
  }
  return Gate(port, s, constant, std::move(parts));
}

}  // namespace

Gate::Gate(std::size_t port, const model::Switch& s, double constant, std::vector<Part> parts)
    : port_(port), constant_(constant), on_level_(s.on_level), off_level_(s.off_level), inverted_(s.inverted), parts_(std::move(parts)) {}

void Gate::begin(bool closed, double stop) {
  holds_ = closed != inverted_;
  stop_ = stop;
  time_ = 0.0;
  for (Part& part : parts_) part.cursor = part.track.before(0.0);
  find_next();
  while (next_ <= 0.0) pass();
}

void Gate::pass() {
  time_ = next_;
  holds_ = !holds_;
  find_next();
}

/// Positive as long as nothing changes.
double Gate::margin(double time) const {
  double value = constant_;
  for (const Part& part : parts_) value += part.coefficient * part.cursor.at(time);
  return holds_ ? value - off_level_ : on_level_ - value;
}

double Gate::next_corner() const {
  double next = model::forever;
  for (const Part& part : parts_) next = std::min(next, part.cursor.next);
  return next;
}

/// Segment by segment, on each of which the control is a line.
void Gate::find_next() {
  next_ = model::forever;
  while (true) {
    const double corner = next_corner();
    const double end = std::min(corner, std::max(stop_, time_));
    const double left = margin(time_), right = margin(end);
    if (right < 0.0) {
      next_ = left > 0.0 ? std::min(time_ + (end - time_) * left / (left - right), end) : time_;
      return;
    }
    if (!(corner < stop_)) return;
    time_ = corner;
    for (Part& part : parts_)
      while (part.cursor.next <= corner) part.track.advance(part.cursor);
  }
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
  for (const auto& b : network.branches) note(b.voltage);
  for (const auto& i : network.injections) note(i.current);
  for (const auto& c : network.complementarities) note(c.slack);
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
