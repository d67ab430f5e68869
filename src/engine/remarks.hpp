#pragma once
/// Remarks that every engine makes in the same words.

#include "engine/run.hpp"

namespace pwlsim::engine {

/// W-certificate: `worst` is the residual that is doubtful.
[[nodiscard]] Remark doubtful_certificate(double worst);

/// W-start-projected: of the whole circuit.
[[nodiscard]] Remark projected_start();

}  // namespace pwlsim::engine
