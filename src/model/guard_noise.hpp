#pragma once
/// Digits of the guards of a mode on a slow manifold.

#include "model/mode.hpp"
#include "model/system.hpp"

namespace pwlsim::model {

/// Where leaks decide a potential, the guards that read it have fewer digits than others: the difference from those at another shift shows how many.
/// The voltage of a blocking port that has none, and is rounding of its own terms, is zero (a diode across a closed switch). `other`: the guards at that
/// shift, as rows of x.
void measure_guard_noise(const System& system, Mode& mode, const linalg::Matrix& other);

}  // namespace pwlsim::model
