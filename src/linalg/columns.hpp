#pragma once
/// Products with dense columns, in which large modes and spaces of vectors spend their time. Where the compiler makes code for several processors, of which the loader takes one, four numbers are gone over
/// at a time; sums are the same to the last bit.

#include <Eigen/Core>

namespace pwlsim::linalg {

/// Columns one after the other, each `apart` behind the one before.
struct DenseColumns {
  const double* data;
  Eigen::Index rows, count, apart;
};
[[nodiscard]] inline DenseColumns first_columns(const Eigen::Ref<const Eigen::MatrixXd>& m, Eigen::Index count) {
  return {m.data(), m.rows(), count, m.outerStride()};
}

/// y += A x. y must not alias x or A.
void add_product(const DenseColumns& a, const double* x, double* y);
/// y += Aᵀ x. y must not alias x or A.
void add_transposed_product(const DenseColumns& a, const double* x, double* y);

}  // namespace pwlsim::linalg
