#include "circuit/source_resistance.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "circuit/node_groups.hpp"

namespace pwlsim::circuit {
namespace {

using elements::FormulaPart;
using elements::Instance;

constexpr double resistance = 1e-3;  // ohm, that of a wire

bool has_letter(const Instance& instance, std::string_view letters) {
  return instance.kind != nullptr && letters.find(instance.kind->letter) != std::string_view::npos;
}

bool is_zero(const Instance& instance, std::string_view parameter) {
  return elements::find_parameter(instance.values.table(), parameter) == nullptr || instance.values.get(parameter) == 0.0;
}

bool sets_voltage_by_formula(const Instance& instance) {
  return instance.formula && (has_letter(instance, "E") || (has_letter(instance, "B") && !instance.formula_is_current));
}

/// A voltage without resistance between the two nodes.
bool is_stiff(const Instance& instance) {
  if (sets_voltage_by_formula(instance)) return instance.series_resistance == 0.0;
  return has_letter(instance, "EH") || (has_letter(instance, "V") && is_zero(instance, "Rser"));
}

bool is_bare_capacitor(const Instance& instance) {
  return has_letter(instance, "C") && is_zero(instance, "Rser") && is_zero(instance, "Lser");
}

/// A choice between constants is a source that jumps.
bool has_corners(const FormulaPart& part) {
  using Kind = FormulaPart::Kind;
  const bool is_choice = part.kind == Kind::choice && !(part.above.is_constant() && part.below.is_constant());
  return part.kind == Kind::positive || part.kind == Kind::step || is_choice;
}

bool reads_itself(const Instance& instance) {
  const auto is_own = [&](model::NodeIndex node) {
    return node != model::ground && (node == instance.nodes[0] || node == instance.nodes[1]);
  };
  return std::any_of(instance.control_nodes.begin(), instance.control_nodes.end(),
                     [&](const elements::NodePair& pair) { return is_own(pair.p) || is_own(pair.n); });
}

/// Whether other elements close a loop without resistance with this source, and capacitors are among them.
bool charges_capacitors(const FlatCircuit& circuit, const Instance& source) {
  NodeGroups groups(circuit.nodes().size());
  const auto join = [&](auto joins) {
    for (const Instance& other : circuit.instances)
      if (&other != &source && other.nodes.size() == 2 && joins(other)) groups.join(other.nodes[0], other.nodes[1]);
    return groups.root(source.nodes[0]) == groups.root(source.nodes[1]);
  };
  return !join(is_stiff) && join(is_bare_capacitor);
}

}  // namespace

void resist_capacitors(FlatCircuit& circuit, Reporter& reporter) {
  for (Instance& source : circuit.instances) {
    if (!sets_voltage_by_formula(source) || source.nodes.size() != 2 || reads_itself(source)) continue;
    const auto& parts = source.formula->parts;
    if (!std::any_of(parts.begin(), parts.end(), has_corners) || !charges_capacitors(circuit, source)) continue;
    source.series_resistance = resistance;
    reporter.note("N-source-resistance", source.span,
                  fmt::format("{} charges a capacitor with an expression that has corners: 1 mohm is in series with it; try a resistor of "
                              "your own for another value",
                              source.name));
  }
}

}  // namespace pwlsim::circuit
