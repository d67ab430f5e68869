#pragma once
/// Messages of `.ac`, of one run and of those of .step.

#include <string>

#include "base/diagnostic.hpp"

namespace pwlsim::cli {

/// W-ac-singular; `where`: " in the run with …".
[[nodiscard]] Diagnostic singular_response_warning(double frequency, const std::string& where = "");

}  // namespace pwlsim::cli
