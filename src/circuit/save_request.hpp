#pragma once
/// Signals as cards name them: v(a), v(a,b), i(R1), x(system,1).

#include <optional>

#include "circuit/circuit.hpp"
#include "circuit/reporter.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

/// Of an item of .save, .print, .four: a signal or `all`. Empty after an error.
[[nodiscard]] std::optional<SaveRequest> save_request(const netlist::Item& item, Reporter& reporter);
/// Of a call in an expression.
[[nodiscard]] std::optional<SaveRequest> signal_request(const netlist::Expression& call, Reporter& reporter);
/// Id(M1), Id(J1) or Ic(Q1).
[[nodiscard]] bool is_transistor_current(const netlist::Expression& call);

}  // namespace pwlsim::circuit
