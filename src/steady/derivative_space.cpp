#include "steady/derivative_space.hpp"

#include <algorithm>
#include <cmath>

#include "linalg/factorisations.hpp"
#include "steady/tolerances.hpp"

namespace pwlsim::steady {
namespace {

constexpr Eigen::Index columns_at_once = 16;  ///< columns at once

/// Of least norm where the matrix is singular.
linalg::Vector least_squares(const linalg::Matrix& m, const linalg::Vector& right) {
  if (m.cols() == 0) return {};
  Eigen::CompleteOrthogonalDecomposition<linalg::Matrix> decomposition;
  decomposition.setThreshold(tolerance::zero_singular_value);
  decomposition.compute(m);
  return decomposition.solve(right);
}

void widen(linalg::Matrix& matrix, Eigen::Index columns) {
  if (matrix.cols() < columns) matrix.conservativeResize(Eigen::NoChange, std::max(columns, 2 * matrix.cols()));
}

}  // namespace

DerivativeSpace::DerivativeSpace(const Operator& phi, const Vector& start) : phi_(phi) {
  const Vector x = phi.measure(start);
  norm_ = x.norm();
  full_ = !(norm_ > 0.0);
  vectors_.resize(start.size(), columns_at_once);
  mapped_.resize(start.size(), columns_at_once);
  measured_.resize(x.size(), columns_at_once);
  h_ = Matrix::Zero(1, 0);
  if (full_) return;
  vectors_.col(0) = start / norm_;
  measured_.col(0) = x / norm_;
}

bool DerivativeSpace::grow() {
  const int j = dimension_;
  for (Matrix* matrix : {&vectors_, &mapped_, &measured_}) widen(*matrix, j + 2);
  Vector image = vectors_.col(j);
  if (!phi_.apply(image)) return false;
  mapped_.col(j) = image;
  Vector x = phi_.measure(image);
  const double size = x.norm();
  const double h = linalg::append_to_hessenberg(measured_.leftCols(j + 1), x, h_);
  const Vector c = h_.col(j).head(j + 1);
  dimension_ = j + 1;
  full_ = !(h > tolerance::invariant_space * std::max(size, 1.0)) || dimension_ >= x.size();
  if (full_) return true;
  vectors_.col(j + 1) = (image - vectors_.leftCols(j + 1) * c) / h;
  measured_.col(j + 1) = x / h;
  return true;
}

linalg::Matrix DerivativeSpace::shifted(double s) const {
  Matrix m = -h_;
  m.diagonal().array() += s;
  return m;
}

double DerivativeSpace::residual(double s) const {
  if (!(norm_ > 0.0)) return 0.0;
  Vector right = Vector::Zero(dimension_ + 1);
  right[0] = 1.0;
  const Matrix m = shifted(s);
  return (right - m * least_squares(m, right)).norm();
}

DerivativeSpace::Solution DerivativeSpace::solve(double s) const {
  Vector right = Vector::Zero(dimension_ + 1);
  right[0] = norm_;
  const Matrix m = shifted(s);
  const Vector y = least_squares(m, right);
  return {unknowns(y), mapped(y), (right - m * y).norm()};
}

std::vector<DerivativeSpace::Pair> DerivativeSpace::pairs() const {
  std::vector<Pair> pairs;
  if (dimension_ == 0) return pairs;
  const Eigen::EigenSolver<Matrix> eigen(Matrix(h_.topRows(dimension_)));
  const double h = h_(dimension_, dimension_ - 1);
  for (Eigen::Index i = 0; i < dimension_; ++i) {
    Pair pair{eigen.eigenvalues()[i], eigen.eigenvectors().col(i), 0.0};
    pair.coordinates /= pair.coordinates.norm();
    pair.residual = h * std::abs(pair.coordinates[dimension_ - 1]);
    pairs.push_back(std::move(pair));
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return std::abs(a.value) > std::abs(b.value); });
  return pairs;
}

linalg::Vector DerivativeSpace::part_at_one(double width) const {
  if (dimension_ == 0) return {};
  const Eigen::EigenSolver<Matrix> eigen(Matrix(h_.topRows(dimension_)));
  Eigen::VectorXcd right = Eigen::VectorXcd::Zero(dimension_);
  right[0] = norm_;
  Eigen::VectorXcd share = eigen.eigenvectors().fullPivLu().solve(right);
  for (Eigen::Index i = 0; i < dimension_; ++i)
    if (std::abs(eigen.eigenvalues()[i] - 1.0) > width) share[i] = 0.0;
  return (eigen.eigenvectors() * share).real();
}

linalg::Vector DerivativeSpace::unknowns(const Vector& coordinates) const { return vectors_.leftCols(coordinates.size()) * coordinates; }
linalg::Vector DerivativeSpace::mapped(const Vector& coordinates) const { return mapped_.leftCols(coordinates.size()) * coordinates; }
linalg::Vector DerivativeSpace::measured(const Vector& coordinates) const { return measured_.leftCols(coordinates.size()) * coordinates; }

}  // namespace pwlsim::steady
