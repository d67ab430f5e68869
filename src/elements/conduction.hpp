#pragma once
/// Two-slope characteristics: slope 1/Roff everywhere, 1/Ron when the element conducts.

#include "elements/emission.hpp"

namespace pwlsim::elements {

/// The resistance r in series with an ideal contact that, in parallel with `off`, gives `on`: 1/r = 1/on − 1/off, for 0 ≤ on ≤ off.
/// Infinite if on = off: then there is no contact.
[[nodiscard]] double contact_resistance(double on, double off);

/// Adds the resistor `off` from p to n, if finite, and its current to that of the element.
void add_leakage(Emission& emission, double off, const NodePair& ends);

}  // namespace pwlsim::elements
