#pragma once
/// Items of cards: words, and signals as cards name them (v(a), v(a,b), i(R1), x(system,1)).

#include <optional>
#include <string_view>

#include "base/names.hpp"
#include "circuit/circuit.hpp"
#include "circuit/reporter.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

/// The bare word `text`, in any case.
[[nodiscard]] inline bool is_word(const netlist::Item& item, std::string_view text) {
  return item.kind == netlist::Item::Kind::word && same_name(item.text, text);
}

/// Of an item of .save, .print, .four: a signal or `all`. Empty after an error.
[[nodiscard]] std::optional<SaveRequest> save_request(const netlist::Item& item, Reporter& reporter);
/// Of a call in an expression.
[[nodiscard]] std::optional<SaveRequest> signal_request(const netlist::Expression& call, Reporter& reporter);
/// Id(M1), Id(J1) or Ic(Q1).
[[nodiscard]] bool is_transistor_current(const netlist::Expression& call);

}  // namespace pwlsim::circuit
