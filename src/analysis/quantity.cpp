#include "analysis/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace pwlsim::analysis {
namespace {

struct Prefix {
  double factor;
  std::string_view text;
};
constexpr std::array<Prefix, 9> prefixes{
    {{1e9, "G"}, {1e6, "M"}, {1e3, "k"}, {1.0, ""}, {1e-3, "m"}, {1e-6, "µ"}, {1e-9, "n"}, {1e-12, "p"}, {1e-15, "f"}}};

}  // namespace

std::string quantity(double value, std::string_view unit, int digits) {
  if (unit.empty()) return fmt::format("{:.{}g}", value, digits);
  if (value == 0.0) return fmt::format("0 {}", unit);
  const double rounded = std::strtod(fmt::format("{:.{}g}", value, digits).c_str(), nullptr);  // 999.9999 is 1 k with three digits
  for (const Prefix& prefix : prefixes) {
    const double scaled = rounded / prefix.factor;
    if (std::abs(scaled) >= 1.0 && std::abs(scaled) < 1e3)
      return fmt::format("{:.{}g} {}{}", scaled, std::max(digits, 3), prefix.text, unit);  // 110 with two digits is no 1.1e+02
  }
  return fmt::format("{:.{}g} {}", value, digits, unit);
}

std::string counted(std::uint64_t count, std::string_view noun) {
  const std::string_view plural = noun.ends_with("ch") ? "es" : "s";
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : plural);
}

std::string_view unit_of_signal(std::string_view name) {
  if (name.size() < 2 || name[1] != '(') return "";
  return name[0] == 'v' || name[0] == 'V' ? "V" : name[0] == 'i' || name[0] == 'I' ? "A" : "";
}

}  // namespace pwlsim::analysis
