#pragma once
/// Sums in twice the digits of extended precision (Dekker 1971, A floating-point technique for extending the available precision,
/// Numerische Mathematik 18).

#include <limits>

#include "linalg/dense.hpp"

namespace pwlsim::linalg {

/// value + rest, where `rest` is the rounding error of `value`.
struct Doubled {
  Wide value = 0, rest = 0;

  void add(Wide term) {
    const Wide sum = value + term;
    const Wide share = sum - value;
    rest += (value - (sum - share)) + (term - share);
    value = sum;
  }

  void add_product(Wide a, Wide b) {
    // Cuts a number into two halves whose products are exact.
    constexpr Wide splitter = static_cast<Wide>(1ULL << ((std::numeric_limits<Wide>::digits + 1) / 2)) + 1;
    const Wide product = a * b;
    const Wide a_scaled = splitter * a, b_scaled = splitter * b;
    const Wide a_high = a_scaled - (a_scaled - a), b_high = b_scaled - (b_scaled - b);
    const Wide a_low = a - a_high, b_low = b - b_high;
    rest += ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    add(product);
  }
};

}  // namespace pwlsim::linalg
