#pragma once
/// Makers who say in the name of a part what it is: resistance and voltage of a MOSFET, current and voltage of a diode.

#include <optional>
#include <string_view>

#include "circuit/device.hpp"

namespace pwlsim::circuit {

/// The device that the letters and digits of `key`, in lower case, spell; none where no maker's system reads them. Diodes get a drop that is typical of their kind.
[[nodiscard]] std::optional<Device> read_part_number(std::string_view key);

}  // namespace pwlsim::circuit
