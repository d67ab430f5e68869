#include "elements/conduction.hpp"

#include <cmath>

namespace pwlsim::elements {

double contact_resistance(double on, double off) {
  if (std::isinf(off) || on == 0.0) return on;
  if (on == off) return infinite;
  return on * (off / (off - on));
}

void add_leakage(Emission& emission, double off, const NodePair& ends) {
  if (std::isinf(off)) return;
  const int index = emission.builder().add(model::Resistor{emission.label("Roff"), ends.p, ends.n, off});
  emission.result().current.push_back({Quantity::resistor_current, index, 1.0});
}

}  // namespace pwlsim::elements
