#pragma once
/// What R, C and L share: multiplicity, and the parasitic parts as LTspice places them:
/// the core in series with Rser and Lser, and Rpar and Cpar across the whole.

#include "elements/emission.hpp"

namespace pwlsim::elements {

inline constexpr Parameter multiplicity{"m", "", 1.0, Range::positive, false, "Number of equal elements in parallel."};
inline constexpr Parameter series_resistance{"Rser", "ohm", 0.0, Range::any, false, "Resistance in series."};
inline constexpr Parameter series_inductance{"Lser", "H", 0.0, Range::any, false, "Inductance in series."};
inline constexpr Parameter parallel_resistance{"Rpar", "ohm", infinite, Range::any, true, "Resistance across the whole element."};
inline constexpr Parameter parallel_capacitance{"Cpar", "F", 0.0, Range::any, false, "Capacitance across the whole element."};
inline constexpr Parameter temperature_linear{"tc1", "1/K", 0.0, Range::any, false, "Temperature coefficient.", Use::ignored};
inline constexpr Parameter temperature_square{"tc2", "1/K^2", 0.0, Range::any, false, "Temperature coefficient.", Use::ignored};
inline constexpr Parameter temperature_both{"tc", "1/K", 0.0, Range::any, false, "Temperature coefficients, one or two.", Use::ignored};
inline constexpr Parameter temperature{"temp", "C", 27.0, Range::any, false, "Temperature of the element.", Use::ignored};
inline constexpr Parameter temperature_difference{"dtemp", "K", 0.0, Range::any, false, "Temperature above the circuit's.", Use::ignored};
inline constexpr Parameter maker{"mfg", "", 0.0, Range::any, true, "Manufacturer.", Use::ignored};
inline constexpr Parameter part_number{"pn", "", 0.0, Range::any, true, "Part number.", Use::ignored};
inline constexpr Parameter part_type{"type", "", 0.0, Range::any, true, "Type of the part.", Use::ignored};

/// Adds Rser and Lser; returns the nodes of the core.
[[nodiscard]] NodePair add_series_parts(Emission& emission);

/// Adds Rpar and Cpar across the terminals, and their currents to that of the element.
void add_parallel_parts(Emission& emission);

}  // namespace pwlsim::elements
