#pragma once
/// A measured efficiency above 1 is not that of the circuit: its window does not contain whole periods, or stored energy changes within it.

#include <vector>

#include "base/diagnostic.hpp"
#include "circuit/compile.hpp"
#include "measure/measuring.hpp"

namespace pwlsim::analysis {

/// W-efficiency for each quotient of two results that is named as an efficiency (`eff…`, `eta…`) and lies above 1.
[[nodiscard]] std::vector<Diagnostic> efficiency_warnings(const circuit::Compiled& compiled, const measure::Results& results);

}  // namespace pwlsim::analysis
