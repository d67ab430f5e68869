#include "linalg/columns.hpp"

#include <cstring>

// Without GNU's library there may be no loader that takes one of several, and sanitizers start after it.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define PWLSIM_FOR_SEVERAL_PROCESSORS __attribute__((target_clones("avx2", "default")))
#else
#define PWLSIM_FOR_SEVERAL_PROCESSORS
#endif

namespace pwlsim::linalg {

using Eigen::Index;

PWLSIM_FOR_SEVERAL_PROCESSORS void add_product(const DenseColumns& a, const double* x, double* y) {
  const Index rows = a.rows, apart = a.apart;
  double* __restrict sum = y;
  const double* __restrict column = a.data;
  Index j = 0;
  // Sources at rest, and the inputs of derivatives, are zero throughout.
  for (; j + 4 <= a.count; j += 4, column += 4 * apart) {
    const double first = x[j], second = x[j + 1], third = x[j + 2], fourth = x[j + 3];
    if (first == 0.0 && second == 0.0 && third == 0.0 && fourth == 0.0) continue;
    for (Index i = 0; i < rows; ++i)
      sum[i] += (column[i] * first + column[i + apart] * second) + (column[i + 2 * apart] * third + column[i + 3 * apart] * fourth);
  }
  for (; j < a.count; ++j, column += apart) {
    const double factor = x[j];
    if (factor == 0.0) continue;
    for (Index i = 0; i < rows; ++i) sum[i] += column[i] * factor;
  }
}

PWLSIM_FOR_SEVERAL_PROCESSORS void add_transposed_product(const DenseColumns& a, const double* x, double* y) {
  using Four [[gnu::vector_size(32)]] = double;
  const Index rows = a.rows, in_fours = rows - rows % 4, apart = a.apart;
  const double* column = a.data;
  const auto sum_of = [](const Four& sums) { return (sums[0] + sums[1]) + (sums[2] + sums[3]); };
  const auto add = [](const double* from, const Four& of_x, Four& sums) {
    Four terms;
    std::memcpy(&terms, from, sizeof terms);
    sums += terms * of_x;
  };
  Index j = 0;
  for (; j + 4 <= a.count; j += 4, column += 4 * apart) {
    Four first{}, second{}, third{}, fourth{};
    for (Index i = 0; i < in_fours; i += 4) {
      Four of_x;
      std::memcpy(&of_x, x + i, sizeof of_x);
      add(column + i, of_x, first);
      add(column + apart + i, of_x, second);
      add(column + 2 * apart + i, of_x, third);
      add(column + 3 * apart + i, of_x, fourth);
    }
    double sums[4] = {sum_of(first), sum_of(second), sum_of(third), sum_of(fourth)};
    for (Index k = 0; k < 4; ++k) {
      for (Index i = in_fours; i < rows; ++i) sums[k] += column[k * apart + i] * x[i];
      y[j + k] += sums[k];
    }
  }
  for (; j < a.count; ++j, column += apart) {
    Four sums{};
    for (Index i = 0; i < in_fours; i += 4) {
      Four of_x;
      std::memcpy(&of_x, x + i, sizeof of_x);
      add(column + i, of_x, sums);
    }
    double sum = sum_of(sums);
    for (Index i = in_fours; i < rows; ++i) sum += column[i] * x[i];
    y[j] += sum;
  }
}

}  // namespace pwlsim::linalg
