#pragma once
/// Units of measured values.

#include <cstddef>
#include <string>

#include "circuit/measurement.hpp"

namespace pwlsim::measure {

/// "V", "A", "W", "Ω", "S", "s", "Vs", "C", "J", …; "" if the value has none or the units of its parts do not match.
[[nodiscard]] std::string unit_of(const circuit::Measurements& measurements, std::size_t index);

}  // namespace pwlsim::measure
