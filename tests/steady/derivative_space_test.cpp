#include "steady/derivative_space.hpp"

#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cmath>

#include "steady/known_inverse.hpp"

using pwlsim::linalg::Matrix;
using pwlsim::linalg::Vector;
using pwlsim::steady::DerivativeSpace;
using pwlsim::steady::KnownInverse;

namespace {

/// D + shift of a Householder reflection's conjugation: eigenvalues are those of D.
struct Known {
  Vector eigenvalues;
  Matrix phi;
};

Known known_map(int n) {
  Known known;
  known.eigenvalues.resize(n);
  for (int i = 0; i < n; ++i) known.eigenvalues[i] = std::pow(0.5, i);
  known.eigenvalues[0] = 0.999;
  Vector v(n), u(n);
  for (int i = 0; i < n; ++i) {
    v[i] = 1.0 + 0.1 * i;
    u[i] = 1.0 / (1.0 + i);
  }
  const Matrix s = Matrix::Identity(n, n) + v * u.transpose() / 7.0;  // no orthogonal eigenvectors
  known.phi = s * known.eigenvalues.asDiagonal() * s.inverse();
  return known;
}

DerivativeSpace::Operator operator_of(const Matrix& phi) {
  return {[&phi](Vector& v) {
            v = phi * v;
            return true;
          },
          [](const Vector& v) { return v; }};
}

}  // namespace

TEST_CASE("Arnoldi's space of a matrix with known eigenvalues", "[unit]") {
  constexpr int n = 30;
  const Known known = known_map(n);
  const auto phi = operator_of(known.phi);
  const Vector right = Vector::LinSpaced(n, 1.0, 2.0);
  DerivativeSpace space(phi, right);
  for (int m = 0; m < 14 && !space.is_full(); ++m) REQUIRE(space.grow());
  const auto pairs = space.pairs();
  for (std::size_t k = 0; k < 4; ++k) {
    const double value = known.eigenvalues[static_cast<Eigen::Index>(k)];
    CHECK(std::abs(pairs[k].value - value) <= 1e-8);
    CHECK(pairs[k].residual <= 1e-7);
    const Vector v = space.unknowns(pairs[k].coordinates.real());
    CHECK((known.phi * v - value * v).norm() <= 1e-7 * v.norm());
    CHECK((space.mapped(pairs[k].coordinates.real()) - known.phi * v).norm() <= 1e-12 * v.norm());
  }
  for (const double s : {1.0, 1.25}) {
    const auto solution = space.solve(s);
    const Vector left = right - (s * solution.delta - known.phi * solution.delta);
    CHECK(left.norm() == Approx(solution.residual).margin(1e-11 * right.norm()));
    CHECK(solution.residual <= 1e-4 * right.norm());
    CHECK(space.residual(s) * right.norm() == Approx(solution.residual).margin(1e-11 * right.norm()));
  }
}

TEST_CASE("what a period adds is the part of the residual along the eigenvalue 1", "[unit]") {
  Matrix phi = Matrix::Zero(3, 3);
  phi(0, 0) = 1.0;
  phi(0, 1) = 0.3;  // the eigenvector of 1 is e₁, its left one (1, 0.6, 0)
  phi(1, 1) = 0.5;
  phi(2, 2) = 0.2;
  const auto operation = operator_of(phi);
  const Vector right = (Vector(3) << 1.0, 1.0, 1.0).finished();
  DerivativeSpace space(operation, right);
  while (!space.is_full()) REQUIRE(space.grow());
  const Vector part = space.unknowns(space.part_at_one(1e-9));
  CHECK((part - (Vector(3) << 1.6, 0.0, 0.0).finished()).norm() <= 1e-12);
}

// Φ differs by rank one from a map whose inverse is known: Ψ is of rank one, so that its space is full after two vectors.
TEST_CASE("what is known of an inverse leaves few vectors to find for the next map", "[unit]") {
  constexpr int n = 30;
  Matrix phi = known_map(n).phi;
  const auto operation = operator_of(phi);
  const Vector right = Vector::LinSpaced(n, 1.0, 2.0);
  KnownInverse inverse(operation);
  const auto space_of = [&] {
    DerivativeSpace space(inverse.psi(), right);
    while (!space.is_full() && (space.dimension() == 0 || space.residual(1.0) > 1e-10)) REQUIRE(space.grow());
    return space;
  };
  const DerivativeSpace first = space_of();
  inverse.learn(first);
  REQUIRE(!inverse.is_empty());
  phi += 0.1 * right * Vector::Unit(n, 3).transpose();
  const DerivativeSpace next = space_of();
  CHECK(first.dimension() >= 10);
  CHECK(next.dimension() <= 4);
  const Vector delta = inverse.applied(next.solve(1.0).delta);
  CHECK((delta - phi * delta - right).norm() <= 1e-9 * right.norm());
  inverse.forget();
  CHECK(inverse.is_empty());
}

TEST_CASE("no known inverse solves for what a period adds", "[unit]") {
  Matrix phi = Matrix::Zero(3, 3);
  phi(0, 0) = 0.9;
  phi(0, 1) = 0.3;
  phi(1, 1) = 0.5;
  phi(2, 2) = 0.2;
  const auto operation = operator_of(phi);
  const Vector right = (Vector(3) << 1.0, 1.0, 1.0).finished();
  KnownInverse inverse(operation);
  const auto space_of = [&] {
    DerivativeSpace space(inverse.psi(), right);
    while (!space.is_full()) REQUIRE(space.grow());
    return space;
  };
  inverse.learn(space_of());
  phi(0, 0) = 1.0;  // the left eigenvector of 1 is (1, 0.6, 0): so much of the right-hand side is out of reach
  const DerivativeSpace space = space_of();
  CHECK(space.residual(1.0) >= 1.6 / std::sqrt(1.36 * 3.0) - 1e-9);
  const DerivativeSpace singular = [&] {
    inverse.forget();
    return space_of();
  }();
  inverse.learn(singular);
  CHECK(inverse.is_empty());
}
