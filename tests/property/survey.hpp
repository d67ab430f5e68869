#pragma once
/// Families of random networks, and all checks over many members of one.

#include <string>
#include <vector>

#include "engine/run.hpp"
#include "property/random_network.hpp"

namespace pwlsim::test {

struct Family {
  std::string name;
  std::uint64_t first_seed = 0;
  Recipe recipe;
  bool independent = true;  ///< whether implicit Euler can follow them
};

[[nodiscard]] const std::vector<Family>& families();
[[nodiscard]] const Family& family(const std::string& name);

/// What must hold: see examination.hpp, and agreement.hpp.
struct Checks {
  bool properties = true, independent = true;
};

struct Survey {
  int networks = 0, refused = 0, wrong = 0;
  std::vector<std::string> failures;                         ///< with seed and smallest deck: the first few
  engine::Certificate worst;                                 ///< largest of each residual
  int most_ports = 0;                                        ///< diodes and switches of one network
  int compared = 0, whole = 0, windows = 0;                  ///< with the independent solution; as one window; windows in all
  double difference = 0.0, extrapolated = 0.0, order = 0.0;  ///< largest, largest, median over networks (agreement.hpp)
};

[[nodiscard]] Survey survey(const Family& family, int networks, const Checks& checks);

}  // namespace pwlsim::test
