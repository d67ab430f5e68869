#pragma once
/// Lists of names.

#include <algorithm>
#include <span>
#include <string_view>

#include "base/names.hpp"

namespace pwlsim {

/// Names are compared without case.
[[nodiscard]] constexpr bool is_one_of(std::span<const std::string_view> list, std::string_view name) {
  return std::any_of(list.begin(), list.end(), [&](std::string_view other) { return same_name(other, name); });
}

}  // namespace pwlsim
