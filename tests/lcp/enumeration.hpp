#pragma once
/// Random problems, and their solutions by trying everything.

#include <cstdint>
#include <random>
#include <vector>

#include "linalg/dense.hpp"

namespace pwlsim::test {

/// Numbers of order one, the same with every standard library.
class Problems {
 public:
  explicit Problems(std::uint64_t seed) : engine_(seed) {}
  double number() { return 2.0 * (static_cast<double>(engine_() >> 11U) * 0x1p-53) - 1.0; }
  int below(int count) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(count)); }
  linalg::Matrix matrix(int rows, int columns) {
    return linalg::Matrix::NullaryExpr(rows, columns, [&] { return number(); });
  }
  linalg::Vector vector(int size) {
    return linalg::Vector::NullaryExpr(size, [&] { return number(); });
  }
  std::vector<int> subset(int k);
  /// G Gᵀ of the given rank, plus a skew part.
  linalg::Matrix semidefinite(int k, int rank);

 private:
  std::mt19937_64 engine_;
};

/// Every z ≥ 0 with w = Mz + q ≥ 0 that some nonsingular principal submatrix gives.
[[nodiscard]] std::vector<linalg::Vector> enumerate(const linalg::Matrix& m, const linalg::Vector& q);
[[nodiscard]] bool is_among(const linalg::Vector& z, const std::vector<linalg::Vector>& solutions, double agreement);

struct Point {
  bool exists = false;
  linalg::Vector z, w;
};

/// The solution (z, w) nearest to a target: each of the 3^k ways to set z_i, w_i or both to zero is an equality-constrained least-squares
/// problem; of those whose answers have the right signs the nearest is taken.
[[nodiscard]] Point nearest_solution(const linalg::Matrix& m, const linalg::Vector& q, const linalg::Vector& target_z,
                                     const linalg::Vector& target_w);

/// Whether all principal minors are positive.
[[nodiscard]] bool is_p_matrix(const linalg::Matrix& m);

}  // namespace pwlsim::test
