#include "converters/variants.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace pwlsim::test::converters {
namespace {

using Kind = Branch::Kind;

bool is_state(const Branch& branch) { return branch.kind == Kind::capacitor || branch.kind == Kind::inductor; }

Variant unchanged(const Converter& converter, std::string name) {
  Variant variant;
  variant.name = std::move(name);
  variant.converter = converter;
  const auto signals = static_cast<std::size_t>(std::ranges::count_if(converter.branches, is_state));
  variant.source.resize(signals);
  std::iota(variant.source.begin(), variant.source.end(), std::size_t{0});
  variant.factor.assign(signals, 1.0);
  return variant;
}

/// Names stay, and so do the nodes: only their order of appearance changes.
Variant in_another_order(const Converter& converter, Draw& draw) {
  Variant variant = unchanged(converter, "order");
  std::vector<Branch>& branches = variant.converter.branches;
  std::vector<std::size_t> order(branches.size()), signal(branches.size());
  for (std::size_t b = 0, k = 0; b < branches.size(); ++b) {
    order[b] = b;
    signal[b] = is_state(branches[b]) ? k++ : 0;
  }
  for (std::size_t b = branches.size(); b > 1; --b) std::swap(order[b - 1], order[draw.bits() % b]);
  variant.source.clear();
  for (std::size_t b = 0; b < branches.size(); ++b) {
    branches[b] = converter.branches[order[b]];
    if (is_state(branches[b])) variant.source.push_back(signal[order[b]]);
  }
  return variant;
}

Variant with_swapped_terminals(const Converter& converter, Draw& draw) {
  Variant variant = unchanged(converter, "terminals");
  std::size_t signal = 0;
  for (Branch& branch : variant.converter.branches) {
    const bool coupled = std::ranges::any_of(converter.couplings, [&](const Coupling& coupling) {
      return std::ranges::find(coupling.inductors, branch.name) != coupling.inductors.end();
    });
    const bool swaps = (branch.kind == Kind::resistor || is_state(branch)) && !coupled && draw.chance(0.6);
    if (swaps) {
      std::swap(branch.plus, branch.minus);
      branch.initial = branch.initial == 0.0 ? 0.0 : -branch.initial;
    }
    if (is_state(branch)) variant.factor[signal++] = swaps ? -1.0 : 1.0;
  }
  return variant;
}

void scale_time(Wave& wave, double factor) {
  wave.frequency /= factor;
  for (double* time : {&wave.delay, &wave.rise, &wave.fall, &wave.width, &wave.period}) *time *= factor;
}

Variant in_other_units(const Converter& converter, Draw& draw) {
  const double time = std::ldexp(1.0, draw.integer(-12, 12)), impedance = std::ldexp(1.0, draw.integer(-12, 12)),
               voltage = std::ldexp(1.0, draw.integer(-8, 8));
  Variant variant = unchanged(converter, fmt::format("time*{} impedance*{} voltage*{}", time, impedance, voltage));
  Converter& scaled = variant.converter;
  std::size_t signal = 0;
  for (Branch& branch : scaled.branches) {
    const bool is_voltage = branch.kind == Kind::capacitor;
    if (branch.kind == Kind::resistor) branch.value *= impedance;
    if (branch.kind == Kind::inductor) branch.value *= impedance * time;
    if (branch.kind == Kind::capacitor) branch.value *= time / impedance;
    const double factor = is_voltage ? voltage : voltage / impedance;
    branch.initial *= factor;
    branch.holding *= voltage / impedance;
    if (is_state(branch)) variant.factor[signal++] = factor;
    scale_time(branch.wave, time);
    for (double* volts : {&branch.wave.offset, &branch.wave.amplitude, &branch.wave.high}) *volts *= voltage;
  }
  for (Wave& gate : scaled.gates) scale_time(gate, time);
  for (Contact& model : scaled.models) {
    model.on *= impedance;
    model.off *= impedance;
    model.drop *= voltage;
  }
  for (double* seconds : {&scaled.stop, &scaled.row_step, &scaled.fast}) *seconds *= time;
  return variant;
}

Variant with_twice_the_rows(const Converter& converter) {
  Variant variant = unchanged(converter, "rows");
  variant.converter.row_step /= 2;
  variant.row_stride = 2;
  return variant;
}

}  // namespace

std::vector<Variant> make_variants(const Converter& converter, Draw& draw) {
  return {in_another_order(converter, draw), with_swapped_terminals(converter, draw), in_other_units(converter, draw),
          with_twice_the_rows(converter)};
}

}  // namespace pwlsim::test::converters
