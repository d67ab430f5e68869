#include "elements/two_terminal.hpp"

#include <cmath>

namespace pwlsim::elements {
namespace {

void add_current(Emission& emission, Quantity kind, int index) { emission.result().current.push_back({kind, index, 1.0}); }

}  // namespace

NodePair add_series_parts(Emission& emission) {
  NodePair core{emission.p(), emission.n()};
  const double m = emission.value("m");
  if (const double r = emission.value("Rser"); r != 0.0) {
    const model::NodeIndex inner = emission.inner_node("Rser");
    emission.builder().add(model::Resistor{emission.label("Rser"), inner, core.n, r / m});
    core.n = inner;
  }
  if (const double l = emission.value("Lser"); l != 0.0) {
    const model::NodeIndex inner = emission.inner_node("Lser");
    emission.builder().add(model::Inductor{emission.label("Lser"), inner, core.n, l / m, false, 0.0});
    core.n = inner;
  }
  return core;
}

void add_parallel_parts(Emission& emission) {
  const double m = emission.value("m");
  if (const double r = emission.value("Rpar"); !std::isinf(r)) {
    const int index = emission.builder().add(model::Resistor{emission.label("Rpar"), emission.p(), emission.n(), r / m});
    add_current(emission, Quantity::resistor_current, index);
  }
  if (const double c = emission.value("Cpar"); c != 0.0) {
    const int index = emission.builder().add(model::Capacitor{emission.label("Cpar"), emission.p(), emission.n(), c * m, false, 0.0});
    add_current(emission, Quantity::capacitor_current, index);
  }
}

}  // namespace pwlsim::elements
