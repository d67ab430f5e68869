#include "circuit/memory_block.hpp"

#include <string>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/formula_reader.hpp"
#include "circuit/transfer_function.hpp"
#include "elements/catalogue.hpp"

namespace pwlsim::circuit {
namespace {

using elements::Instance;
using model::NodeIndex;

/// "X1.B1.int 2": of the second block of that type of X1.B1.
std::string free_name(const Circuit& circuit, const Instance& owner, std::string_view type) {
  for (int k = 1;; ++k) {
    std::string name = fmt::format("{}.{} {}", owner.name, type, k);
    if (!circuit.find_node(name)) return name;
  }
}

Instance made_part(char letter, std::string name, const Instance& owner, NodeIndex node) {
  Instance instance;
  instance.kind = elements::find_kind(letter);
  instance.name = std::move(name);
  instance.span = owner.span;
  instance.nodes = {node, model::ground};
  instance.values = elements::Values(instance.kind->parameters);
  return instance;
}

}  // namespace

std::optional<NodeIndex> add_memory_block(Binder& binder, Place& place, const Instance& owner, const MemoryBlock& block) {
  Circuit& circuit = binder.circuit();
  circuit.hidden.names.insert(without_case(owner.name));
  const std::string name = free_name(circuit, owner, block.type), input_name = name + " input";
  NodeIndex output = model::ground, input = model::ground;
  if (!circuit.add_node(name, owner.span, output) || !circuit.add_node(input_name, owner.span, input)) return std::nullopt;

  Instance source = made_part('B', input_name, owner, input);
  if (!FormulaReader(binder, place, source).read(block.input, false)) return std::nullopt;
  circuit.instances.push_back(std::move(source));

  Instance memory = made_part('A', name, owner, output);
  memory.inputs = {{false, {input, model::ground}, -1}};
  memory.control_nodes = {{input, model::ground}};
  memory.model = circuit.add_model(block.type, name);
  block.set_values(circuit.models.back().values);
  circuit.instances.push_back(std::move(memory));
  return output;
}

std::optional<NodeIndex> add_transfer_block(Binder& binder, Place& place, const Instance& owner, const netlist::Expression& input,
                                            const netlist::Item& fraction) {
  using Kind = netlist::Expression::Kind;
  const netlist::Expression number{Kind::number, 0.0, fraction.text, {}, fraction.span};
  const bool has_expression = fraction.kind == netlist::Item::Kind::expression;
  const auto transfer = read_transfer_function(has_expression ? *fraction.expression : number, place.scope, binder.reporter(), owner.name);
  if (!transfer) return std::nullopt;
  const auto set_values = [&](elements::Values& values) {  // highest power first
    values.set_list("num_coeff", {transfer->numerator.rbegin(), transfer->numerator.rend()}, fraction.span);
    values.set_list("den_coeff", {transfer->denominator.rbegin(), transfer->denominator.rend()}, fraction.span);
  };
  return add_memory_block(binder, place, owner, {"s_xfer", input, set_values});
}

}  // namespace pwlsim::circuit
