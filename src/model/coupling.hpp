#pragma once
/// The message of both engines about impossible couplings.

#include "base/diagnostic.hpp"
#include "model/network.hpp"

namespace pwlsim::model {

/// E-coupling at the first of them.
inline void report_impossible_coupling(const Network& network, Diagnostics& diagnostics) {
  diagnostics.error("E-coupling", network.couplings.front().label.span,
                    "the couplings of these inductors contradict each other: their inductance matrix is indefinite; "
                    "try smaller coefficients");
}

}  // namespace pwlsim::model
