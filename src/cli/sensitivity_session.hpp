#pragma once
/// What there is to say about derivatives, of a run or of a sweep.

#include <string>

#include "analysis/run_json.hpp"
#include "cli/messages.hpp"

namespace pwlsim::cli {

/// `where`: " in the run with …", or nothing.
void report_derivatives(const analysis::DerivativeTable& table, Messages& messages, const std::string& where = "");

}  // namespace pwlsim::cli
