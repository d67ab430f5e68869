#pragma once
/// Random converters whose switches pass together: complementary, interleaved, phase-shifted and three-level gates, with ramps of 0 to 1 µs, given
/// as pulses, polylines, inverted copies, or comparisons of a sinusoid with a triangle.

#include <cstdint>
#include <string>
#include <vector>

namespace pwlsim::test {

struct GateDeck {
  std::string text;                ///< without .save and .end
  std::string signal;              ///< one that is worth saving
  std::vector<std::string> gates;  ///< "v(g1)"
  bool shares =
      false;  ///< diodes and closed switches in parallel: how they share a current is decided where it is saved, and costs a last digit

  [[nodiscard]] std::string with_save(const std::string& saved) const {
    return text + (saved.empty() ? "" : ".save " + saved + "\n") + ".end\n";
  }
};

[[nodiscard]] GateDeck random_gate_deck(std::uint64_t seed);

}  // namespace pwlsim::test
