#pragma once
/// Arnoldi's method for the derivative Φ of a map whose products Φ·v are all that is known of it:  Φ V = V H + h v eᵀ, V orthonormal in the norm of the energy.
///
/// The same space serves  (s − Φ) δ = f,  least squares as in GMRES, for every s, and gives eigenvalues of Φ with residuals. (Saad, Iterative Methods for Sparse Linear Systems, 2003, §6.5;
/// Numerical Methods for Large Eigenvalue Problems, 2011, §6.2.)

#include <complex>
#include <functional>
#include <vector>

#include "linalg/dense.hpp"

namespace pwlsim::steady {

class DerivativeSpace {
 public:
  using Matrix = linalg::Matrix;
  using Vector = linalg::Vector;
  /// A vector in two forms: its unknowns, and what the norm measures of them.
  struct Operator {
    std::function<bool(Vector& unknowns)> apply;  ///< v := Φ v; false: it has none
    std::function<Vector(const Vector& unknowns)> measure;
  };

  DerivativeSpace(const Operator& phi, const Vector& start);

  /// One vector more. False: Φ·v failed.
  [[nodiscard]] bool grow();
  [[nodiscard]] int dimension() const { return dimension_; }
  /// Nothing is left outside of the space.
  [[nodiscard]] bool is_full() const { return full_; }
  [[nodiscard]] double start_norm() const { return norm_; }

  struct Solution {
    Vector delta, mapped;   ///< unknowns of δ and of Φ δ
    double residual = 0.0;  ///< ‖f − (s − Φ) δ‖, f the start
  };
  [[nodiscard]] Solution solve(double s) const;
  /// Its residual alone, of the start.
  [[nodiscard]] double residual(double s) const;

  struct Pair {
    std::complex<double> value;
    Eigen::VectorXcd coordinates;  ///< of the vector, in V; of norm 1
    double residual = 0.0;         ///< ‖Φ v − λ v‖
  };
  /// The largest first.
  [[nodiscard]] std::vector<Pair> pairs() const;
  [[nodiscard]] Vector unknowns(const Vector& coordinates) const;
  [[nodiscard]] Vector mapped(const Vector& coordinates) const;
  [[nodiscard]] Vector measured(const Vector& coordinates) const;
  /// V, in both forms, and Vᵀ Φ V.
  [[nodiscard]] Matrix basis() const { return vectors_.leftCols(dimension_); }
  [[nodiscard]] Matrix measured_basis() const { return measured_.leftCols(dimension_); }
  [[nodiscard]] Matrix reduced() const { return h_.topRows(dimension_); }
  /// The part of the start along eigenvalues within `width` of 1, in V.
  [[nodiscard]] Vector part_at_one(double width) const;

 private:
  [[nodiscard]] Matrix shifted(double s) const;

  const Operator& phi_;
  Matrix vectors_, mapped_, measured_, h_;
  double norm_ = 0.0;
  int dimension_ = 0;
  bool full_ = false;
};

}  // namespace pwlsim::steady
