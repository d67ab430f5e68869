#include "engine/sparse/controls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/disjoint_sets.hpp"
#include "engine/sparse/tolerances.hpp"
#include "model/islands.hpp"

namespace pwlsim::engine::sparse {

namespace {

enum Turn { gates, latches, drivers, all_others };

/// Of each switch of the network.
std::vector<int> turns_of(const model::Network& network) {
  std::vector<int> turns(network.switches.size(), all_others);
  const auto islands = model::split_islands(network, [](const model::Island&) { return true; });
  const auto is_logic = [](const model::Island& island) { return island.network.capacitors.empty() && island.network.inductors.empty(); };
  std::vector<char> drives_logic(turns.size(), 0);
  for (const model::Island& island : islands)
    for (const int s : island.switch_number) drives_logic[static_cast<std::size_t>(s)] = is_logic(island) ? 1 : 0;
  for (const model::Island& island : islands)
    for (const auto& control : island.controls) {
      if (!is_logic(island)) continue;
      const auto driven = static_cast<std::size_t>(control.driven);
      turns[driven] = drives_logic[driven] == 0 ? drivers : control.on_level == control.off_level ? gates : latches;
    }
  return turns;
}

/// Whether forms are sums of states: currents of inductors, and voltages of nodes that capacitors join.
class StateForms {
 public:
  explicit StateForms(const Descriptor& descriptor)
      : descriptor_(descriptor), joined_(descriptor.nodes() + 1), is_current_(static_cast<std::size_t>(descriptor.size()), 0) {
    for (const State& state : descriptor.states()) {
      if (state.is_current && state.current.empty() && state.flux.empty())
        is_current_[static_cast<std::size_t>(state.plus)] = 1;
      else if (!state.is_current && state.storage != 0.0)
        joined_.join(state.plus + 1, state.minus + 1);
    }
  }
  [[nodiscard]] bool contain(const Form& form) {
    std::map<int, double> sums;  // of the nodes of a set
    double size = 0.0;
    for (const Form::IndexedTerm& part : form.z) {
      if (part.index >= descriptor_.nodes() && is_current_[static_cast<std::size_t>(part.index)] == 0) return false;
      if (part.index >= descriptor_.nodes()) continue;
      size = std::max(size, std::abs(part.coefficient));
      sums[joined_.find(part.index + 1)] += part.coefficient;
    }
    sums.erase(joined_.find(0));  // with ground
    return std::all_of(sums.begin(), sums.end(), [&](const auto& sum) { return std::abs(sum.second) <= tolerance::guard_sign * size; });
  }

 private:
  const Descriptor& descriptor_;
  DisjointSets joined_;
  std::vector<char> is_current_;
};

}  // namespace

double WatchedControl::level_size() const { return std::max({std::abs(on_level), std::abs(off_level), on_level - off_level}); }

double WatchedControl::rounding(double largest_unknown) const {
  double gain = 0.0;
  for (const Form::IndexedTerm& part : value.z) gain = std::max(gain, std::abs(part.coefficient));
  return tolerance::voltage_rounding * gain * largest_unknown;
}

double WatchedControl::noise(double form_value, double largest_unknown) const {
  return std::max(tolerance::guard_sign * std::max({level_size(), largest, std::abs(form_value)}), rounding(largest_unknown));
}

bool WatchedControl::passes_with(const WatchedControl& other, const Position& on) const {
  const auto sign = [&](const WatchedControl& control) { return control.holds(on) ? 1.0 : -1.0; };
  const auto offset = [&](const WatchedControl& control) {
    return sign(control) * (control.value.constant - (control.holds(on) ? control.off_level : control.on_level));
  };
  const auto agree = [&](const std::vector<Form::IndexedTerm>& a, const std::vector<Form::IndexedTerm>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const Form::IndexedTerm& x, const Form::IndexedTerm& y) {
      return x.index == y.index && sign(*this) * x.coefficient == sign(other) * y.coefficient;
    });
  };
  return agree(value.z, other.value.z) && agree(value.w, other.value.w) && offset(*this) == offset(other);
}

std::vector<WatchedControl> controls_of(const model::Network& network, const Descriptor& descriptor) {
  std::vector<WatchedControl> controls;
  StateForms states(descriptor);
  for (std::size_t i = 0; i < network.switches.size(); ++i) {
    const auto& s = network.switches[i];
    controls.push_back(
        {static_cast<std::size_t>(descriptor.first_switch()) + i, descriptor.form(s.control), s.on_level, s.off_level, s.inverted});
    controls.back().reads_states = states.contain(controls.back().value);
  }
  return controls;
}

std::vector<WatchedControl> controls_in_turn(const model::Network& network, const Descriptor& descriptor) {
  std::vector<WatchedControl> controls = controls_of(network, descriptor);
  if (controls.empty()) return controls;
  const std::vector<int> turns = turns_of(network);
  for (std::size_t i = 0; i < controls.size(); ++i) controls[i].turn = turns[i];
  return controls;
}

void keep_first_turn(std::vector<const WatchedControl*>& passed) {
  int first = std::numeric_limits<int>::max();
  for (const WatchedControl* control : passed) first = std::min(first, control->turn);
  std::erase_if(passed, [&](const WatchedControl* control) { return control->turn != first; });
}

Position first_position(const model::Network& network, const Descriptor& descriptor) {
  Position on(descriptor.ports().size(), 0);
  for (std::size_t i = 0; i < network.switches.size(); ++i)
    on[static_cast<std::size_t>(descriptor.first_switch()) + i] = network.switches[i].initially_on != network.switches[i].inverted;
  return on;
}

}  // namespace pwlsim::engine::sparse
