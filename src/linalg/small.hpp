#pragma once
/// Vectors of a length known to the compiler, up to largest_small entries, that stay in registers (two entries in one where the
/// machine has such, as every x86-64 and AArch64 has).

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <cstring>

namespace pwlsim::linalg {

inline constexpr int largest_small = 12;

template <int length>
class Small {
 public:
  static Small load(const double* x) {
    Small result;
    std::memcpy(result.pairs_.data(), x, length * sizeof(double));
    return result;
  }
  void store(double* x) const { std::memcpy(x, pairs_.data(), length * sizeof(double)); }

  [[nodiscard]] double operator[](int i) const { return pairs_[static_cast<std::size_t>(i / 2)][i % 2]; }
  /// this += factor·x.
  void add_multiple(const double* x, double factor) {
    const Pair both{factor, factor};
    for (int i = 0; i < length / 2; ++i) {
      Pair pair;
      std::memcpy(&pair, x + 2 * i, sizeof pair);
      pairs_[static_cast<std::size_t>(i)] += pair * both;
    }
    if constexpr (length % 2 == 1) pairs_[length / 2] += Pair{x[length - 1], 0.0} * both;
  }
  void add(const Small& other) {
    for (std::size_t i = 0; i < pairs_.size(); ++i) pairs_[i] += other.pairs_[i];
  }
  void scale(double factor) {
    for (auto& pair : pairs_) pair *= Pair{factor, factor};
  }
  /// Σ |x_i|.
  [[nodiscard]] double size() const {
    Pair sum{};
    for (const auto& pair : pairs_) sum += magnitude(pair);
    return sum[0] + sum[1];
  }

 private:
  using Pair [[gnu::vector_size(16)]] = double;
  using Bits [[gnu::vector_size(16)]] = std::int64_t;

  static Pair magnitude(Pair pair) {
    constexpr std::int64_t all_but_sign = 0x7FFFFFFFFFFFFFFF;
    return reinterpret_cast<Pair>(reinterpret_cast<Bits>(pair) & Bits{all_but_sign, all_but_sign});
  }

  std::array<Pair, (length + 1) / 2> pairs_{};  ///< of an odd length the last entry is zero
};

/// From this many entries on it pays to test for zeros: derivatives of constant and piecewise-linear sources are zero.
inline constexpr int worth_asking = 7;

/// A·x for a square column-major A.
template <int length>
[[nodiscard]] Small<length> product(const double* a, const Small<length>& x) {
  Small<length> result;
  for (int j = 0; j < length; ++j)
    if (length < worth_asking || x[j] != 0.0) result.add_multiple(a + j * length, x[j]);
  return result;
}

template <int length>
struct Length {};

/// Calls work(Length<n>{}) and returns true if 1 ≤ n ≤ largest_small.
template <typename Work>
inline bool with_length(Eigen::Index n, const Work& work) {
  static_assert(largest_small == 12);
  switch (n) {
    case 1:
      work(Length<1>{});
      return true;
    case 2:
      work(Length<2>{});
      return true;
    case 3:
      work(Length<3>{});
      return true;
    case 4:
      work(Length<4>{});
      return true;
    case 5:
      work(Length<5>{});
      return true;
    case 6:
      work(Length<6>{});
      return true;
    case 7:
      work(Length<7>{});
      return true;
    case 8:
      work(Length<8>{});
      return true;
    case 9:
      work(Length<9>{});
      return true;
    case 10:
      work(Length<10>{});
      return true;
    case 11:
      work(Length<11>{});
      return true;
    case 12:
      work(Length<12>{});
      return true;
    default:
      return false;
  }
}

}  // namespace pwlsim::linalg
