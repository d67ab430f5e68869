#pragma once
/// Messages about derivatives, of a run or of a sweep.

#include <string>

#include "analysis/run_json.hpp"
#include "cli/messages.hpp"

namespace pwlsim::cli {

/// `where`: " in the run with …", or "".
void report_derivatives(const analysis::DerivativeTable& table, Messages& messages, const std::string& where = "");

}  // namespace pwlsim::cli
