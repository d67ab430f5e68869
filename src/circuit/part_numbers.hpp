#pragma once
/// Decodes part numbers that contain ratings: resistance and voltage of a MOSFET, current and voltage of a diode.

#include <optional>
#include <string>
#include <string_view>

namespace pwlsim::circuit {

/// A model at hand: one row of lib/devices.txt, or decoded from a part number.
struct Device {
  std::string_view type;   ///< of its model: D, NPN, VDMOS, …
  std::string parameters;  ///< `Vfwd=0.7 Ron=2 Vrev=100`
  std::string_view source;
};

/// The device for the letters and digits of `key`, in lower case; none if no maker's system matches. Diodes get a drop typical of their kind.
[[nodiscard]] std::optional<Device> read_part_number(std::string_view key);

}  // namespace pwlsim::circuit
