#pragma once
/// Leaks of 1 GΩ to 10 PΩ at the ends of inductors. Where blocked valves leave such a node to its inductor, the leak makes a time constant of L/R that is up to 10²⁰ times shorter than the run.

#include <cstdint>

#include "converters/netlist.hpp"

namespace pwlsim::test::converters {

/// The same for the same seed: every second end that is not ground, one at least, has a leak to ground. `converter` without an inductor stays as it is.
void hang_leaks(Converter& converter, std::uint64_t seed);

}  // namespace pwlsim::test::converters
