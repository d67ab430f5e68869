#pragma once
/// Units of measured values.

#include <cstddef>
#include <string>

#include "circuit/measurement.hpp"

namespace pwlsim::measure {

/// "V", "A", "W", "Ω", "S", "s", "Vs", "C", "J", …; "" where the value has none or its parts do not fit together.
[[nodiscard]] std::string unit_of(const circuit::Measurements& measurements, std::size_t index);

}  // namespace pwlsim::measure
