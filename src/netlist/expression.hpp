#pragma once
/// Expressions on a card. All functions are linear in the text they read and recurse into nothing.

#include "netlist/ast.hpp"
#include "netlist/context.hpp"

namespace pwlsim::netlist {

/// {…} or '…': `first` stands on the opening character and is moved behind the closing one, or to `last` where that is missing.
/// False where an error was reported; `result` is then a NaN number with the span of what was skipped.
bool parse_delimited_expression(const char*& first, const char* last, const ParseContext& context, Expression& result);

/// An expression without braces, as long as it goes: it ends before the first token that cannot continue it.
/// After an error the rest of the card is skipped.
bool parse_open_expression(const char*& first, const char* last, const ParseContext& context, Expression& result);

}  // namespace pwlsim::netlist
