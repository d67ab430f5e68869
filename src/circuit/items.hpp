#pragma once
/// Tests of a card's items.

#include <string_view>

#include "base/names.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

/// The bare word `text`, in any case.
[[nodiscard]] inline bool is_word(const netlist::Item& item, std::string_view text) {
  return item.kind == netlist::Item::Kind::word && same_name(item.text, text);
}

}  // namespace pwlsim::circuit
