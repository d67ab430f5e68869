#pragma once
/// Names as the netlist language compares them: ASCII letters without case.

#include <algorithm>
#include <span>
#include <string>
#include <string_view>

namespace pwlsim {

[[nodiscard]] constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
[[nodiscard]] constexpr char lower_letter(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// The key under which a name is stored.
[[nodiscard]] inline std::string without_case(std::string_view name) {
  std::string key(name);
  std::transform(key.begin(), key.end(), key.begin(), lower_letter);
  return key;
}

[[nodiscard]] constexpr bool same_name(std::string_view a, std::string_view b) {
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(), [](char x, char y) { return lower_letter(x) == lower_letter(y); });
}

/// Whether it is one of these, without case.
[[nodiscard]] constexpr bool is_one_of(std::span<const std::string_view> list, std::string_view name) {
  return std::any_of(list.begin(), list.end(), [&](std::string_view other) { return same_name(other, name); });
}

/// Whether the name is `0` or `gnd`: ground, the same node everywhere.
[[nodiscard]] constexpr bool is_ground_name(std::string_view name) { return name == "0" || same_name(name, "gnd"); }

}  // namespace pwlsim
