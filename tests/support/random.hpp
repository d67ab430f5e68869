#pragma once
/// Random numbers that are the same with every standard library.

#include <cstddef>
#include <cstdint>
#include <random>

namespace pwlsim::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// In [0, 1).
  double unit() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  /// In low … high, both included.
  int whole(int low, int high) { return low + static_cast<int>(unit() * (high - low + 1)); }
  bool chance(double probability) { return unit() < probability; }
  /// One of a list that is not empty.
  template <class List>
  const auto& one_of(const List& list) {
    return *(std::begin(list) + static_cast<std::ptrdiff_t>(unit() * static_cast<double>(std::size(list))));
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace pwlsim::test
