#pragma once
/// Random numbers of expressions: the same on every machine for the same seed.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace pwlsim::circuit {

/// SplitMix64 (Steele, Lea & Flood 2014).
class Random {
 public:
  Random() = default;
  Random(std::uint64_t seed, std::uint64_t run) : state_(seed ^ (run * 0xd1342543de82ef95ULL)) {}

  /// Uniform in [0, 1).
  double uniform();
  /// Mean 0, variance 1 (Box–Muller).
  double normal();

 private:
  std::uint64_t state_ = 0;
};

struct RandomFunction {
  std::string_view name;
  std::size_t arguments = 1;
  double (*value)(std::span<const double> arguments, Random& random) = nullptr;
};
/// Null where there is none of that name with so many arguments.
[[nodiscard]] const RandomFunction* find_random_function(std::string_view name, std::size_t arguments);
[[nodiscard]] bool is_random_function(std::string_view name);

}  // namespace pwlsim::circuit
