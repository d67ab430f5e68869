#include "circuit/random.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/names.hpp"

namespace pwlsim::circuit {
namespace {

using ArgumentValues = std::span<const double>;

double both_ways(Random& random) { return 2.0 * random.uniform() - 1.0; }

/// LTspice: gauss(σ), flat(a), mc(value, tolerance). ngspice: the others, whose last argument is the number of σ that a spread means.
constexpr RandomFunction random_functions[] = {
    {"gauss", 1, [](ArgumentValues a, Random& r) { return a[0] * r.normal(); }},
    {"flat", 1, [](ArgumentValues a, Random& r) { return a[0] * both_ways(r); }},
    {"mc", 2, [](ArgumentValues a, Random& r) { return a[0] * (1.0 + a[1] * both_ways(r)); }},
    {"gauss", 3, [](ArgumentValues a, Random& r) { return a[0] * (1.0 + a[1] / a[2] * r.normal()); }},
    {"agauss", 3, [](ArgumentValues a, Random& r) { return a[0] + a[1] / a[2] * r.normal(); }},
    {"unif", 2, [](ArgumentValues a, Random& r) { return a[0] * (1.0 + a[1] * both_ways(r)); }},
    {"aunif", 2, [](ArgumentValues a, Random& r) { return a[0] + a[1] * both_ways(r); }},
};

}  // namespace

double Random::uniform() {
  constexpr double unit = 0x1p-53;
  std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  return static_cast<double>((z ^ (z >> 31U)) >> 11U) * unit;
}

double Random::normal() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

const RandomFunction* find_random_function(std::string_view name, std::size_t arguments) {
  const auto* found = std::find_if(std::begin(random_functions), std::end(random_functions),
                                   [&](const RandomFunction& f) { return same_name(f.name, name) && f.arguments == arguments; });
  return found == std::end(random_functions) ? nullptr : found;
}

bool is_random_function(std::string_view name) {
  return std::any_of(std::begin(random_functions), std::end(random_functions),
                     [&](const RandomFunction& f) { return same_name(f.name, name); });
}

}  // namespace pwlsim::circuit
