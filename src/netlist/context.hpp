#pragma once
/// The context that the grammars of one card share.

#include <string>
#include <string_view>

#include "netlist/lines.hpp"
#include "netlist/syntax_errors.hpp"

namespace pwlsim::netlist {

struct ParseContext {
  const LogicalLine& line;
  SyntaxErrors& errors;
  int parentheses = 1000;  ///< how deep they may nest

  void note(const char* id, std::string_view part, std::string text) const { errors.note(id, line.span(part), std::move(text)); }
  void report(const char* id, std::string_view part, std::string text) const { errors.report(id, line.span(part), std::move(text)); }
};

/// [first, last) as a view.
[[nodiscard]] inline std::string_view part(const char* first, const char* last) { return {first, static_cast<std::size_t>(last - first)}; }

/// The first code point of [first, last), which is not empty.
[[nodiscard]] inline std::string_view first_character(const char* first, const char* last) {
  const char* end = first + 1;
  while (end != last && (static_cast<unsigned char>(*end) & 0xC0U) == 0x80U) {
    ++end;
  }
  return part(first, end);
}

}  // namespace pwlsim::netlist
