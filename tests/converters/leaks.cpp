#include "converters/leaks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "converters/draw.hpp"

namespace pwlsim::test::converters {
namespace {

constexpr double least_leak = 1e9, most_leak = 1e16;

std::vector<std::string> ends_of_inductors(const Converter& converter) {
  std::vector<std::string> ends;
  for (const Branch& branch : converter.branches) {
    if (branch.kind != Branch::Kind::inductor) continue;
    for (const std::string& end : {branch.plus, branch.minus})
      if (end != "0" && std::ranges::find(ends, end) == ends.end()) ends.push_back(end);
  }
  return ends;
}

}  // namespace

void hang_leaks(Converter& converter, std::uint64_t seed) {
  const std::vector<std::string> ends = ends_of_inductors(converter);
  if (ends.empty()) return;
  Draw draw(~seed);
  const std::size_t certain = draw.bits() % ends.size();
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (i != certain && !draw.chance(0.5)) continue;
    Branch& leak = converter.branches.emplace_back();
    leak.kind = Branch::Kind::resistor;
    leak.name = fmt::format("Rx{}", i);
    leak.plus = ends[i];
    leak.minus = "0";
    leak.value = draw.logarithmic(least_leak, most_leak);
  }
}

}  // namespace pwlsim::test::converters
