#pragma once
/// Random numbers from a seed (the same with one compiler: arguments are evaluated in no fixed order).

#include <fmt/format.h>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <string>

namespace pwlsim::test::converters {

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : state_(seed) { state_ = bits() ^ (seed << 32); }  // streams of neighbours do not overlap

  std::uint64_t bits() {  // splitmix64
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  bool chance(double probability) { return unit() < probability; }
  int integer(int least, int most) { return least + static_cast<int>(bits() % static_cast<std::uint64_t>(most - least + 1)); }
  /// Three significant digits, as people write values.
  double uniform(double least, double most) { return rounded(least + (most - least) * unit()); }
  double logarithmic(double least, double most) { return rounded(least * std::pow(most / least, unit())); }
  template <class T>
  T pick(std::initializer_list<T> list) {
    return list.begin()[bits() % list.size()];
  }

  static double rounded(double value, int digits = 3) { return std::strtod(fmt::format("{:.{}e}", value, digits - 1).c_str(), nullptr); }

 private:
  std::uint64_t state_;
};

}  // namespace pwlsim::test::converters
