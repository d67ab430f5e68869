#pragma once
/// What must hold for every run of a random passive network.

#include "property/program_run.hpp"
#include "property/random_network.hpp"

namespace pwlsim::test {

/// Runs the network, then renumbered, then with half the output step, and checks that it completes, that its certificate is good, that
/// neither change has an effect, and that without sources the stored energy never rises. `refused`: its linear equations are singular.
[[nodiscard]] Finding examine(const RandomNetwork& network, std::uint64_t seed);

/// The network with every part removed that the finding does not need.
[[nodiscard]] RandomNetwork minimised(const RandomNetwork& network, std::uint64_t seed, const Finding& finding);

}  // namespace pwlsim::test
