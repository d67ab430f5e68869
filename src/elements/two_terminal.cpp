#include "elements/two_terminal.hpp"

#include <cmath>

#include "elements/twin.hpp"

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

TwinEnds twin_of_series_parts(Twin& twin) {
  TwinEnds core = twin.ends();
  const double m = twin.value("m");
  if (const double r = twin.value("Rser"); r != 0.0) {
    const std::string inner = twin.inner("Rser");
    twin.resistor("Rser", {inner, core.n}, r / m);
    core.n = inner;
  }
  if (const double l = twin.value("Lser"); l != 0.0) {
    const std::string inner = twin.inner("Lser");
    twin.inductor("Lser", {inner, core.n}, l / m);
    core.n = inner;
  }
  return core;
}

void twin_of_parallel_parts(Twin& twin) {
  const double m = twin.value("m");
  if (const double r = twin.value("Rpar"); !std::isinf(r)) twin.resistor("Rpar", twin.ends(), r / m);
  if (const double c = twin.value("Cpar"); c != 0.0) twin.capacitor("Cpar", twin.ends(), c * m);
}

}  // namespace pwlsim::elements
