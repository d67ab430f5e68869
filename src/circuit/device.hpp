#pragma once
/// A model at hand: one row of lib/devices.txt, or decoded from a part number.

#include <string>
#include <string_view>

namespace pwlsim::circuit {

struct Device {
  std::string_view type;   ///< of its model: D, NPN, VDMOS, …
  std::string parameters;  ///< `Vfwd=0.7 Ron=2 Vrev=100`
  std::string_view source;
};

}  // namespace pwlsim::circuit
