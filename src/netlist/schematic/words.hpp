#pragma once
/// Splits lines of LTspice's files into words and numbers.

#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>

#include "netlist/lines.hpp"

namespace pwlsim::netlist {

/// Removes and returns the first word of `rest`; empty at the end.
[[nodiscard]] inline std::string_view take_word(std::string_view& rest) {
  rest = trimmed(rest);
  std::size_t end = 0;
  while (end < rest.size() && !is_blank(rest[end])) ++end;
  const std::string_view word = rest.substr(0, end);
  rest.remove_prefix(end);
  return word;
}

/// Removes and returns the last word of `rest`.
[[nodiscard]] inline std::string_view take_last_word(std::string_view& rest) {
  rest = trimmed(rest);
  std::size_t begin = rest.size();
  while (begin > 0 && !is_blank(rest[begin - 1])) --begin;
  const std::string_view word = rest.substr(begin);
  rest = trimmed(rest.substr(0, begin));
  return word;
}

/// Removes and returns the first line of `rest`, without its end.
[[nodiscard]] inline std::string_view take_line(std::string_view& rest) {
  const std::size_t end = rest.find('\n');
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  return line;
}

/// A coordinate: a whole number small enough for all computations without overflow.
[[nodiscard]] inline std::optional<std::int32_t> read_coordinate(std::string_view word) {
  constexpr std::int32_t farthest = 100'000'000;
  std::int32_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || value > farthest || value < -farthest) return std::nullopt;
  return value;
}

}  // namespace pwlsim::netlist
