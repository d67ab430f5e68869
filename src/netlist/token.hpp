#pragma once
/// The tokens of an expression.

#include <string_view>
#include <vector>

namespace pwlsim::netlist {

struct Token {
  enum class Kind {
    number,
    name,
    call,    ///< a name and the `(` after it; `text` is the name alone
    signal,  ///< V(a,b) or I(x): `text` is V, `nodes` are a and b, to which rules of numbers and operators do not apply
    sign,    ///< an operator of one or two characters
    open,    ///< ( or {
    close,   ///< ) or }
    comma,
    question,
    colon
  };
  Kind kind = Kind::number;
  std::string_view text;
  std::string_view whole;
  std::vector<std::string_view> nodes;
};

/// Reads the token at `first`, which is not at a blank; false if no token begins there.
bool next_token(const char*& first, const char* last, Token& token);

}  // namespace pwlsim::netlist
