#pragma once
/// The basic parser of the X3 grammars, and their classes of bytes.

#include <boost/spirit/home/x3.hpp>
#include <string_view>

namespace pwlsim::netlist {

namespace x3 = boost::spirit::x3;

/// One byte of a class decided by a function. Bytes from 0x80 on are parts of UTF-8 letters.
template <bool (*accepts)(unsigned char)>
struct ByteParser : x3::char_parser<ByteParser<accepts>> {
  using char_type = char;
  using attribute_type = char;
  static constexpr bool has_attribute = true;

  template <typename Context>
  bool test(char c, const Context&) const {
    return accepts(static_cast<unsigned char>(c));
  }
};

constexpr bool blank_byte(unsigned char c) { return c <= ' '; }
constexpr bool digit_byte(unsigned char c) { return c >= '0' && c <= '9'; }
constexpr bool letter_byte(unsigned char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c >= 0x80; }
/// Names of parameters and functions.
constexpr bool name_first_byte(unsigned char c) { return letter_byte(c) || c == '_' || c == '#' || c == '$' || c == '@'; }
constexpr bool name_rest_byte(unsigned char c) { return name_first_byte(c) || digit_byte(c) || c == '.'; }

/// The attribute of x3::raw as text.
template <typename Range>
std::string_view view_of(const Range& range) {
  return {range.begin(), static_cast<std::size_t>(range.end() - range.begin())};
}

}  // namespace pwlsim::netlist
