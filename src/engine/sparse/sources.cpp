#include "engine/sparse/sources.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

namespace pwlsim::engine::sparse {

Sources::Sources(const model::Network& network)
    : exosystem_(model::source_functions(network), true), phase_(exosystem_.start()), count_(network.sources.size()) {
  zeta_.assign(static_cast<std::size_t>(exosystem_.size()), 0.0);
}

void Sources::evaluate(double time, std::vector<double>& w) const {
  exosystem_.evaluate(phase_, time, zeta_.data());
  w.resize(count_);
  exosystem_.values(zeta_.data(), w.data());
}

void Sources::states(double time, std::vector<double>& zeta) const {
  zeta.resize(static_cast<std::size_t>(exosystem_.size()));
  exosystem_.evaluate(phase_, time, zeta.data());
}

double Sources::shortest_period() const {
  double period = model::forever;
  for (const auto& block : exosystem_.blocks())
    if (block.kind == model::Exosystem::Block::Kind::oscillation && block.omega > 0.0)
      period = std::min(period, 2.0 * std::numbers::pi / block.omega);
  return period;
}

namespace {

/// Of a function of straight lines; two periods show all that it repeats.
double largest_on(const model::Track& track, double stop) {
  model::Track::Cursor cursor = track.before(0.0);
  double largest = std::abs(cursor.at(0.0));
  for (std::size_t left = track.prefix.size() + 2 * track.loop.size() + 1; left > 0; --left) {
    largest = std::max(largest, std::abs(cursor.at(std::min(cursor.next, stop))));
    if (!(cursor.next <= stop) || cursor.next == model::forever) break;
    track.advance(cursor);
    largest = std::max(largest, std::abs(cursor.value));
  }
  return largest;
}

/// Of a form, as far as sources and constants go.
double largest_of_sources(const model::LinearForm& form, const model::Network& network, double stop) {
  double sum = 0.0;
  for (const auto& term : form) {
    if (term.kind == model::Term::Kind::one) sum += std::abs(term.coefficient);
    if (term.kind == model::Term::Kind::source)
      sum += std::abs(term.coefficient) * largest_value(network.sources[static_cast<std::size_t>(term.index)].function, stop);
  }
  return sum;
}

}  // namespace

double largest_value(const model::SourceFunction& function, double stop) {
  struct Bound {
    double stop;
    double operator()(const model::Dc& f) const { return std::abs(f.value); }
    double operator()(const model::Held& f) const { return std::abs(f.value); }
    double operator()(const model::Sin& f) const { return std::abs(f.offset) + std::abs(f.amplitude); }
    double operator()(const model::Pulse& f) const { return largest_on(model::make_track(f), stop); }
    double operator()(const model::Pwl& f) const { return largest_on(model::make_track(f), stop); }
    double operator()(const model::Exp& f) const { return std::max(std::abs(f.v1), std::abs(f.v2)); }
    double operator()(const model::SmallInput&) const { return 0.0; }
  };
  return std::visit(Bound{stop}, function);
}

double largest_held_voltage(const model::Network& network, double stop) {
  double largest = 0.0;
  for (const auto& branch : network.branches) largest = std::max(largest, largest_of_sources(branch.voltage, network, stop));
  return largest;
}

double largest_injected_current(const model::Network& network, double stop) {
  double largest = 0.0;
  for (const auto& injection : network.injections) largest = std::max(largest, largest_of_sources(injection.current, network, stop));
  return largest;
}

}  // namespace pwlsim::engine::sparse
