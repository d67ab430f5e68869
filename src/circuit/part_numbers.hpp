#pragma once
/// Decodes part numbers that contain ratings: resistance and voltage of a MOSFET, current and voltage of a diode.

#include <optional>
#include <string_view>

#include "circuit/device.hpp"

namespace pwlsim::circuit {

/// The device for the letters and digits of `key`, in lower case; none if no maker's system matches. Diodes get a drop typical of their kind.
[[nodiscard]] std::optional<Device> read_part_number(std::string_view key);

}  // namespace pwlsim::circuit
