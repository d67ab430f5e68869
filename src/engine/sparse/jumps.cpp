#include "engine/sparse/jumps.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::engine::sparse {

namespace {

/// Values of the stores in SI units: voltages, currents, and fluxes of perfectly coupled inductors.
std::vector<double> store_values(const Descriptor& descriptor, const std::vector<double>& measured) {
  std::vector<double> values;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const State& state = descriptor.states()[i];
    const double unit = !state.is_current ? 1.0 : (state.flux.empty() ? 1.0 : state.storage) / descriptor.r0();
    values.push_back(unit * measured[i]);
  }
  return values;
}

std::string store_name(const Part& part, std::size_t i) {
  const auto& n = part.island.network;
  if (i >= n.capacitors.size()) {
    const bool is_flux = !part.descriptor.states()[i].flux.empty();
    return (is_flux ? "flux(" : "i(") + n.inductors[i - n.capacitors.size()].label.name + ")";
  }
  return n.capacitors[i].state.empty() ? "v(" + n.capacitors[i].label.name + ")" : n.capacitors[i].state;
}

/// ½ C v² + ½ iᵀ L i; of perfectly coupled inductors ½ flux²/L of the first of a pair.
double stored_energy(const Part& part, const std::vector<double>& values) {
  const auto& n = part.island.network;
  const auto& states = part.descriptor.states();
  const std::size_t first = n.capacitors.size();
  double energy = 0.0;
  const auto is_flux = [&](std::size_t inductor) { return !states[first + inductor].flux.empty(); };
  for (std::size_t i = 0; i < values.size(); ++i)
    if (i < first || !is_flux(i - first)) energy += 0.5 * states[i].storage * values[i] * values[i];
  std::vector<char> counted(n.inductors.size(), 0);
  for (const auto& k : n.couplings) {
    const auto a = static_cast<std::size_t>(k.inductor_a), b = static_cast<std::size_t>(k.inductor_b);
    const double la = n.inductors[a].inductance, lb = n.inductors[b].inductance;
    if (!is_flux(a) && !is_flux(b)) {
      energy += k.coefficient * std::sqrt(std::abs(la)) * std::sqrt(std::abs(lb)) * values[first + a] * values[first + b];
    } else if (is_flux(a) && is_flux(b)) {
      if (counted[a] == 0 && counted[b] == 0 && la != 0.0) energy += 0.5 * values[first + a] * values[first + a] / la;
      counted[a] = counted[b] = 1;
    }
  }
  return energy;
}

/// The largest charge, and the largest flux, that stores took. Infinite where what stores of that kind took, in √energy, is less than a share of what the others did: it is rounding.
struct Taken {
  double charge = 0.0, flux = 0.0;
};

Taken taken(const Part& part, const std::vector<double>& before, const std::vector<double>& after, double share) {
  Taken result;
  double of_charges = 0.0, of_fluxes = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const State& state = part.descriptor.states()[i];
    const double content = std::abs(after[i] - before[i]) * (state.flux.empty() ? std::abs(state.storage) : 1.0);
    double& largest = state.is_current ? result.flux : result.charge;
    double& all = state.is_current ? of_fluxes : of_charges;
    largest = std::max(largest, content);
    if (state.storage != 0.0) all = std::hypot(all, content / std::sqrt(std::abs(state.storage)));
  }
  if (of_charges < share * of_fluxes) result.charge = INFINITY;
  if (of_fluxes < share * of_charges) result.flux = INFINITY;
  return result;
}

/// Charges through ports that conduct, fluxes across those that block; of multipliers what is no rate.
std::vector<Jump::PortImpulse> impulses(const Part& part, const JumpSteps& steps, const Taken& size, double share) {
  const Descriptor& d = part.descriptor;
  const auto diodes = part.island.network.diodes.size();
  std::vector<Jump::PortImpulse> result;
  for (std::size_t i = 0; i < d.ports().size(); ++i) {
    const DescriptorPort& port = d.ports()[i];
    const bool on = steps.second.on[i] != 0;
    if (i >= diodes && !port.is_switch && !on) continue;  // a multiplier at rest
    const auto of = [&](const Point& at) { return port.free_variable(on, at.z.data(), at.w.data()); };
    double value = steps.h * (of(steps.first) - of(steps.second));
    if (on) value /= d.r0();
    if (!on && port.is_switch) value = -value;  // from its first node to its second
    if (std::abs(value) > share * (on ? size.charge : size.flux)) result.push_back({port.name, on ? "C" : "Vs", value});
  }
  return result;
}

}  // namespace

Jump describe_jump(const Part& part, const JumpEnds& ends, const JumpSteps& steps, double share) {
  const std::vector<double> before = store_values(part.descriptor, ends.before), after = store_values(part.descriptor, ends.after);
  Jump jump;
  jump.time = ends.time;
  jump.impulses = impulses(part, steps, taken(part, before, after, share), share);
  for (std::size_t i = 0; i < before.size(); ++i)
    if (std::abs(after[i] - before[i]) > share * std::max(std::abs(before[i]), std::abs(after[i])))
      jump.states.push_back({store_name(part, i), before[i], after[i]});
  jump.energy_before = stored_energy(part, before);
  jump.energy_after = stored_energy(part, after);
  return jump;
}

}  // namespace pwlsim::engine::sparse
