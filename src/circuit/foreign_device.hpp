#pragma once
/// LTspice's own A devices, which have eight nodes before their type: five inputs, the complement, the output, and the common.

#include <string>
#include <vector>

namespace pwlsim::circuit {

inline constexpr std::size_t foreign_device_nodes = 8;

/// What to write instead of one of this type: for a gate the card of a source B with levels of 0 and 1 V.
[[nodiscard]] std::string instead_of_device(const std::string& type, const std::vector<std::string>& nodes);

}  // namespace pwlsim::circuit
