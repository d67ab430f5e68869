#pragma once
/// Messages of `.ac`, of one run and of those of .step.

#include <string>
#include <vector>

#include "base/diagnostic.hpp"

namespace pwlsim::cli {

/// W-ac-singular; `where`: " in the run with …".
[[nodiscard]] Diagnostic singular_response_warning(double frequency, const std::string& where = "");

/// W-ac-impulse.
[[nodiscard]] Diagnostic impulsive_response_warning(const std::vector<std::string>& signals, const std::string& where = "");

}  // namespace pwlsim::cli
