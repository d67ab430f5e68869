#pragma once
/// Random converters in closed loop. Each can be written in several ways that must mean the same: the order of its cards, comparisons as formulas or
/// devices, inverters and buffers of several kinds, chains of them.

#include <cstdint>
#include <string>

namespace pwlsim::test {

struct ClosedLoop {
  std::string name;  ///< power stage and control
  std::string text;
};

/// Way 0 is the plain one.
[[nodiscard]] ClosedLoop random_closed_loop(std::uint64_t seed, int way);

}  // namespace pwlsim::test
