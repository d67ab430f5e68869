#pragma once
/// One logical line -> one card, by the X3 grammar of card_grammar.cpp.

#include "netlist/ast.hpp"
#include "netlist/context.hpp"

namespace pwlsim::netlist {

/// False, with an error reported, if the line does not begin with a name. Other errors give a damaged card.
[[nodiscard]] bool parse_card(const ParseContext& context, Card& card);

/// The first word of a line, which `parse_card` takes as a card's name.
[[nodiscard]] std::string_view card_name(std::string_view line);

}  // namespace pwlsim::netlist
