#pragma once
/// Expressions on a card. All functions take linear time and do not recurse.

#include "netlist/ast.hpp"
#include "netlist/context.hpp"

namespace pwlsim::netlist {

/// {…} or '…': `first` is at the opening character and is moved past the closing one, or to `last` if that is missing.
/// False if an error was reported; `result` is then a NaN number with the span of the skipped text.
bool parse_delimited_expression(const char*& first, const char* last, const ParseContext& context, Expression& result);

/// An expression without braces: it ends before the first token that cannot continue it.
/// After an error the rest of the card is skipped.
bool parse_open_expression(const char*& first, const char* last, const ParseContext& context, Expression& result);

}  // namespace pwlsim::netlist
