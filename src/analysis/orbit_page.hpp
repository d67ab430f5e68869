#pragma once
/// The part of the report page that shows an orbit's multipliers and small signals.

#include <string>

#include "analysis/run_json.hpp"

namespace pwlsim::analysis {

/// A section of HTML with pictures; "" if there is neither an orbit nor a response.
[[nodiscard]] std::string orbit_section(const RunOutcome& outcome);

}  // namespace pwlsim::analysis
