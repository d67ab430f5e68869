#include "elements/raw_system.hpp"

#include <fmt/format.h>

#include "elements/emission.hpp"

namespace pwlsim::elements {
namespace {

using model::LinearForm;

/// Σ rows[index][k]·quantities[k]
void add_row(LinearForm& form, const Rows& rows, std::size_t index, const std::vector<LinearForm>& quantities) {
  if (rows.empty()) return;
  for (std::size_t k = 0; k < quantities.size(); ++k)
    if (rows[index][k] != 0.0) model::accumulate(form, quantities[k], rows[index][k]);
}

void emit(Emission& emission) {
  const RawSystem& raw = *emission.instance().raw_system;
  model::Builder& builder = emission.builder();
  RawSignals& signals = emission.result().raw;
  std::vector<LinearForm> inputs;
  std::vector<model::NodeIndex> nodes;
  for (int i = 0; i < raw.states; ++i) {
    nodes.push_back(emission.inner_node(fmt::format("x{}", i + 1)));
    model::Capacitor capacitor{emission.label(), nodes.back(), model::ground, 1.0, true, raw.start[static_cast<std::size_t>(i)]};
    capacitor.starts_there = true;
    capacitor.state = fmt::format("x({},{})", emission.label().name, i + 1);
    builder.add(std::move(capacitor));
    signals.x.push_back(model::voltage_between(nodes.back(), model::ground));
  }
  const auto first = static_cast<int>(builder.network().complementarities.size());
  for (int i = 0; i < raw.ports; ++i) signals.u.push_back(quantity(Quantity::slack_input, first + i));
  for (const auto& function : raw.inputs)
    inputs.push_back(quantity(Quantity::source, builder.add(model::Source{emission.label(), function})));
  const auto row = [&](const Rows& of_x, const Rows& of_u, const Rows& of_w, std::size_t index) {
    LinearForm form;
    add_row(form, of_x, index, signals.x);
    add_row(form, of_u, index, signals.u);
    add_row(form, of_w, index, inputs);
    return form;
  };
  for (std::size_t i = 0; i < nodes.size(); ++i)
    builder.add(model::Injection{emission.label(), model::ground, nodes[i], row(raw.a, raw.b, raw.e, i)});
  for (int i = 0; i < raw.ports; ++i) {
    signals.y.push_back(row(raw.c, raw.d, raw.f, static_cast<std::size_t>(i)));
    builder.add(model::Complementarity{emission.label(), signals.y.back()});
  }
}

Kind make_kind() {
  Kind kind;
  kind.name = "raw system";
  kind.letter = '.';
  kind.usage = ".lcs name \"file\"";
  kind.text = "A raw linear complementarity system.";
  kind.terminals = 0;
  kind.has_current = false;
  kind.controls_others = false;
  kind.emit = emit;
  return kind;
}

}  // namespace

const Kind& raw_system_kind() {
  static const Kind kind = make_kind();
  return kind;
}

}  // namespace pwlsim::elements
