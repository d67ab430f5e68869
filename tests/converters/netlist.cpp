#include "converters/netlist.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pwlsim::test::converters {
namespace {

using Kind = Branch::Kind;

std::string initial_text(const Branch& branch) { return fmt::format(" ic={}", branch.initial); }

std::string card(const Branch& branch) {
  const std::string head = fmt::format("{} {} {} ", branch.name, branch.plus, branch.minus);
  switch (branch.kind) {
    case Kind::resistor:
      return head + fmt::format("{}", branch.value);
    case Kind::inductor:
    case Kind::capacitor:
      return head + fmt::format("{}", branch.value) + initial_text(branch);
    case Kind::source:
      return head + branch.wave.text();
    case Kind::diode:
      return head + fmt::format("DX{}", branch.model);
    case Kind::thyristor:
      break;
    case Kind::contact:
      return head + fmt::format("g{} 0 SX{}", branch.gate, branch.model);
  }
  return {};
}

/// With a gate source of its own.
std::string thyristor_cards(const Branch& branch, const Converter& converter) {
  const Contact& model = converter.models[branch.model];
  std::string result = fmt::format("X{0} {1} {2} g{0} thyristor ron={3} vf={4} ih={5}\nVg{0} g{0} {2} {6}", branch.name, branch.plus,
                                   branch.minus, model.on, model.drop, branch.holding, converter.gates[branch.gate].text());
  if (!std::isinf(model.off)) result += fmt::format("\nRoff{} {} {} {}", branch.name, branch.plus, branch.minus, model.off);
  return result;
}

std::string model_text(const Converter& converter, std::size_t index) {
  const Contact& model = converter.models[index];
  const bool of_diode =
      std::ranges::any_of(converter.branches, [&](const Branch& branch) { return branch.kind == Kind::diode && branch.model == index; });
  const std::string off = std::isinf(model.off) ? "" : fmt::format(" Roff={}", model.off);
  if (of_diode) return fmt::format(".model DX{} D(Ron={}{} Vfwd={})\n", index, model.on, off, model.drop);
  return fmt::format(".model SX{} SW(Ron={}{} Vt=0.5)\n", index, model.on, off);
}

}  // namespace

Wave constant(double value) {
  Wave wave;
  wave.offset = value;
  return wave;
}

Wave sine(double amplitude, double frequency, double phase) {
  Wave wave;
  wave.kind = Wave::Kind::sine;
  wave.amplitude = amplitude;
  wave.frequency = frequency;
  wave.phase = phase;
  return wave;
}

Wave pulse(double delay, double rise, double fall, double width, double period) {
  Wave wave;
  wave.kind = Wave::Kind::pulse;
  wave.delay = delay;
  wave.rise = rise;
  wave.fall = fall;
  wave.width = width;
  wave.period = period;
  return wave;
}

long double Wave::value(long double time, long double inside) const {
  if (kind == Kind::constant) return offset;
  if (kind == Kind::sine) {
    const long double turns = std::fmod(static_cast<long double>(frequency) * time + static_cast<long double>(phase) / 360.0L, 1.0L);
    return offset + amplitude * std::sin(2.0L * std::numbers::pi_v<long double> * turns);
  }
  if (inside < delay) return offset;
  const long double start = delay + period * std::floor((inside - delay) / period);
  const long double place = inside - start, at = time - start, swing = static_cast<long double>(high) - offset;
  if (place < rise) return offset + swing * at / rise;
  if (place < static_cast<long double>(rise) + width) return high;
  if (place < static_cast<long double>(rise) + width + fall) return high - swing * (at - rise - width) / fall;
  return offset;
}

double Wave::largest() const {
  const double top = kind == Kind::pulse ? std::abs(high) : 0.0;
  return std::abs(amplitude) + std::max(std::abs(offset), top);
}

std::string Wave::text() const {
  switch (kind) {
    case Kind::constant:
      return fmt::format("{}", offset);
    case Kind::sine:
      return fmt::format("SIN({} {} {} 0 0 {})", offset, amplitude, frequency, phase);
    case Kind::pulse:
      return fmt::format("PULSE({} {} {} {} {} {} {})", offset, high, delay, rise, fall, width, period);
  }
  return {};
}

std::vector<std::string> Converter::signals() const {
  std::vector<std::string> result;
  for (const Branch& branch : branches) {
    if (branch.kind == Kind::capacitor) result.push_back(fmt::format("v({},{})", branch.plus, branch.minus));
    if (branch.kind == Kind::inductor) result.push_back(fmt::format("i({})", branch.name));
  }
  return result;
}

std::string Converter::text() const {
  std::string result = family + "\n";
  for (std::size_t i = 0; i < gates.size(); ++i) result += fmt::format("Vg{0} g{0} 0 {1}\n", i, gates[i].text());
  for (const Branch& branch : branches) result += (branch.kind == Kind::thyristor ? thyristor_cards(branch, *this) : card(branch)) + "\n";
  std::size_t number = 0;
  for (const Coupling& coupling : couplings) {
    result += fmt::format("K{}", ++number);
    for (const std::string& name : coupling.inductors) result += " " + name;
    result += fmt::format(" {}\n", coupling.factor);
  }
  for (std::size_t i = 0; i < models.size(); ++i) result += model_text(*this, i);
  result += fmt::format(".tran {} {} uic\n.save", row_step, stop);
  for (const std::string& name : signals()) result += " " + name;
  return result + "\n.end\n";
}

Branch& ConverterBuilder::add(Branch::Kind kind, const std::string& letter, const std::string& plus, const std::string& minus) {
  const auto of_kind = std::ranges::count_if(converter.branches, [&](const Branch& other) { return other.kind == kind; });
  Branch& branch = converter.branches.emplace_back();
  branch.kind = kind;
  branch.name = fmt::format("{}{}", letter, of_kind + 1);
  branch.plus = plus;
  branch.minus = minus;
  return branch;
}

std::string ConverterBuilder::inductor(const std::string& plus, const std::string& minus, double value, double initial) {
  Branch& branch = add(Kind::inductor, "L", plus, minus);
  branch.value = value;
  branch.initial = initial;
  return branch.name;
}

void ConverterBuilder::capacitor(const std::string& plus, const std::string& minus, double value, double initial) {
  Branch& branch = add(Kind::capacitor, "C", plus, minus);
  branch.value = value;
  branch.initial = initial;
}

void ConverterBuilder::thyristor(const std::string& anode, const std::string& cathode, std::size_t gate, double holding,
                                 std::size_t model) {
  Branch& branch = add(Branch::Kind::thyristor, "T", anode, cathode);
  branch.gate = gate;
  branch.holding = holding;
  branch.model = model;
}

void ConverterBuilder::contact(const std::string& plus, const std::string& minus, std::size_t gate, std::size_t model) {
  Branch& branch = add(Kind::contact, "S", plus, minus);
  branch.gate = gate;
  branch.model = model;
}

std::size_t ConverterBuilder::gate(const Wave& wave) {
  converter.gates.push_back(wave);
  return converter.gates.size() - 1;
}

}  // namespace pwlsim::test::converters
