#include "elements/raw_system.hpp"

#include <fmt/format.h>

#include "elements/emission.hpp"
#include "elements/twin.hpp"

namespace pwlsim::elements {
namespace {

using model::LinearForm;

/// Σ rows[index][k]·quantities[k]
void add_row(LinearForm& form, const Rows& rows, std::size_t index, const std::vector<LinearForm>& quantities) {
  if (rows.empty()) return;
  for (std::size_t k = 0; k < quantities.size(); ++k)
    if (rows[index][k] != 0.0) model::accumulate(form, quantities[k], rows[index][k]);
}

void emit_system(Emission& emission) {
  const RawSystem& raw = *emission.instance().raw_system;
  model::NetworkBuilder& builder = emission.builder();
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

/// Σ rows[index][k]·texts[k]
std::string row_text(const Rows& rows, std::size_t index, const std::vector<std::string>& texts) {
  std::string text;
  if (rows.empty()) return text;
  for (std::size_t k = 0; k < texts.size(); ++k) text += term_text(rows[index][k], texts[k]);
  return text;
}

/// A diode between −y and ground: its current is u. With sharpness X, −y may reach X·u.
void twin_of_system(Twin& twin) {
  const RawSystem& raw = *twin.instance().raw_system;
  std::vector<std::string> x, u, w;
  for (int i = 0; i < raw.states; ++i) {
    const std::string part = fmt::format("x{}", i + 1);
    twin.capacitor(part, {twin.inner(part), "0"}, 1.0);
    twin.start_voltage(twin.inner(part), raw.start[static_cast<std::size_t>(i)]);
    x.push_back(fmt::format("v({})", twin.inner(part)));
  }
  for (int i = 0; i < raw.ports; ++i) u.push_back(current_text(twin.device('V', fmt::format("u{}", i + 1))));
  for (std::size_t i = 0; i < raw.inputs.size(); ++i) {
    const std::string part = fmt::format("w{}", i + 1);
    twin.source(part, {twin.inner(part), "0"}, false, raw.inputs[i]);
    w.push_back(fmt::format("v({})", twin.inner(part)));
  }
  const auto row = [&](const Rows& of_x, const Rows& of_u, const Rows& of_w, std::size_t i) {
    return row_text(of_x, i, x) + row_text(of_u, i, u) + row_text(of_w, i, w);
  };
  for (std::size_t i = 0; i < x.size(); ++i)
    twin.behaviour(fmt::format("dx{}", i + 1), {"0", twin.inner(fmt::format("x{}", i + 1))}, true, row(raw.a, raw.b, raw.e, i));
  for (std::size_t i = 0; i < u.size(); ++i) {
    const std::string y = fmt::format("y{}", i + 1), port = fmt::format("u{}", i + 1);
    twin.behaviour(y, {"0", twin.inner(y)}, false, row(raw.c, raw.d, raw.f, i));
    twin.short_circuit(port, {twin.inner(y), twin.inner(port)});
    twin.diode(port, {twin.inner(port), "0"}, {});
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
  kind.emit = emit_system;
  kind.smooth_twin = twin_of_system;
  return kind;
}

}  // namespace

const Kind& raw_system_kind() {
  static const Kind kind = make_kind();
  return kind;
}

}  // namespace pwlsim::elements
