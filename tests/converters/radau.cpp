#include "converters/radau.hpp"

#include <cmath>
#include <stdexcept>

namespace pwlsim::test::converters {
namespace {

constexpr std::size_t s = Radau::stages;
using Matrix = std::array<std::array<Real, s>, s>;
using ComplexVector = std::array<Complex, s>;
using ComplexMatrix = std::array<ComplexVector, s>;

/// P(s) - P(s-1), Legendre polynomials on [0, 1]: zero at the nodes.
Real node_polynomial(Real x) {
  const Real y = 2 * x - 1;
  Real before = 1, here = y;
  for (std::size_t k = 1; k < s; ++k) {
    const Real next = ((2 * Real(k) + 1) * y * here - Real(k) * before) / Real(k + 1);
    before = here;
    here = next;
  }
  return here - before;
}

std::array<Real, s + 1> find_nodes() {
  std::array<Real, s + 1> nodes{};
  nodes[s] = 1;
  std::size_t found = 0;
  constexpr int parts = 1000;
  for (int i = 0; i + 2 < parts && found + 1 < s; ++i) {
    Real low = Real(i) / parts, high = Real(i + 1) / parts;
    if (node_polynomial(low) * node_polynomial(high) > 0) continue;
    for (int k = 0; k < 80; ++k) {
      const Real middle = (low + high) / 2;
      (node_polynomial(low) * node_polynomial(middle) <= 0 ? high : low) = middle;
    }
    nodes[++found] = (low + high) / 2;
  }
  if (found + 1 != s) throw std::logic_error("Radau nodes");
  return nodes;
}

/// Derivative of the Lagrange polynomial of node j at node i, nodes 0 … s.
Matrix derivative(const std::array<Real, s + 1>& c) {
  Matrix result{};
  for (std::size_t i = 1; i <= s; ++i)
    for (std::size_t j = 1; j <= s; ++j) {
      Real sum = 0;
      for (std::size_t m = 0; m <= s; ++m) {
        if (m == j) continue;
        Real product = 1 / (c[j] - c[m]);
        for (std::size_t k = 0; k <= s; ++k)
          if (k != j && k != m) product *= (c[i] - c[k]) / (c[j] - c[k]);
        sum += product;
      }
      result[i - 1][j - 1] = sum;
    }
  return result;
}

/// Coefficients of det(x - D), highest first (Faddeev and LeVerrier).
std::array<Real, s + 1> characteristic(const Matrix& d) {
  std::array<Real, s + 1> result{};
  result[0] = 1;
  Matrix m{};
  for (std::size_t k = 1; k <= s; ++k) {
    Matrix next{};
    for (std::size_t i = 0; i < s; ++i)
      for (std::size_t j = 0; j < s; ++j) {
        for (std::size_t p = 0; p < s; ++p) next[i][j] += d[i][p] * m[p][j];
        if (i == j) next[i][j] += result[k - 1];
      }
    m = next;
    Real trace = 0;
    for (std::size_t i = 0; i < s; ++i)
      for (std::size_t p = 0; p < s; ++p) trace += d[i][p] * m[p][i];
    result[k] = -trace / Real(k);
  }
  return result;
}

/// All roots (Durand and Kerner).
ComplexVector find_roots(const std::array<Real, s + 1>& coefficients) {
  ComplexVector roots;
  Complex start = 1;
  for (Complex& root : roots) root = start = start * Complex(2.1L, 4.3L) / Complex(1.3L);
  for (int sweep = 0; sweep < 1000; ++sweep)
    for (std::size_t i = 0; i < s; ++i) {
      Complex value = coefficients[0], product = 1;
      for (std::size_t k = 1; k <= s; ++k) value = value * roots[i] + Complex(coefficients[k]);
      for (std::size_t j = 0; j < s; ++j)
        if (j != i) product = product * (roots[i] - roots[j]);
      roots[i] -= value / product;
    }
  return roots;
}

/// a x = b, by elimination with row pivoting.
ComplexVector solve(ComplexMatrix a, ComplexVector b) {
  for (std::size_t k = 0; k < s; ++k) {
    std::size_t best = k;
    for (std::size_t i = k + 1; i < s; ++i)
      if (magnitude(a[i][k]) > magnitude(a[best][k])) best = i;
    std::swap(a[k], a[best]);
    std::swap(b[k], b[best]);
    if (magnitude(a[k][k]) == 0) a[k][k] = 1e-18L;  // inverse iteration wants the direction only
    for (std::size_t i = k + 1; i < s; ++i) {
      const Complex factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j < s; ++j) a[i][j] -= factor * a[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = s; k-- > 0;) {
    for (std::size_t j = k + 1; j < s; ++j) b[k] -= a[k][j] * b[j];
    b[k] = b[k] / a[k][k];
  }
  return b;
}

ComplexVector eigenvector(const Matrix& d, const Complex& value) {
  ComplexMatrix shifted;
  for (std::size_t i = 0; i < s; ++i)
    for (std::size_t j = 0; j < s; ++j) shifted[i][j] = i == j ? Complex(d[i][j]) - value : Complex(d[i][j]);
  ComplexVector vector;
  vector.fill(Complex(1));
  for (int k = 0; k < 3; ++k) {
    vector = solve(shifted, vector);
    Complex largest = 0;
    for (const Complex& entry : vector)
      if (magnitude(entry) > magnitude(largest)) largest = entry;
    for (Complex& entry : vector) entry = entry / largest;
  }
  return vector;
}

Radau make_radau() {
  Radau result;
  result.nodes = find_nodes();
  const Matrix d = derivative(result.nodes);
  const ComplexVector values = find_roots(characteristic(d));
  ComplexMatrix t{};  // columns: the real vector, then each pair
  std::size_t pair = 0;
  const auto put = [&](std::size_t column, const ComplexVector& vector, bool conjugate) {
    for (std::size_t i = 0; i < s; ++i) t[i][column] = {vector[i].re, conjugate ? -vector[i].im : vector[i].im};
  };
  for (const Complex& value : values) {
    if (value.im < -1e-6L) continue;
    const ComplexVector vector = eigenvector(d, value);
    if (value.im <= 1e-6L) {
      result.real_value = value.re;
      put(0, vector, false);
      continue;
    }
    result.complex_values.at(pair) = value;
    put(1 + 2 * pair, vector, false);
    put(2 + 2 * pair, vector, true);
    ++pair;
  }
  for (std::size_t i = 0; i < s; ++i) {
    result.real_vector[i] = t[i][0].re;
    for (std::size_t p = 0; p < Radau::pairs; ++p) result.complex_vectors[p][i] = t[i][1 + 2 * p];
    ComplexVector unit{};
    unit[i] = 1;
    const ComplexVector column = solve(t, unit);  // of T⁻¹
    result.real_row[i] = column[0].re;
    for (std::size_t p = 0; p < Radau::pairs; ++p) result.complex_rows[p][i] = column[1 + 2 * p];
  }
  for (std::size_t j = 1; j <= s; ++j) {
    Real product = 1;
    for (std::size_t m = 0; m <= s; ++m)
      if (m != j) product /= result.nodes[j] - result.nodes[m];
    result.leading[j - 1] = std::ldexp(product, 1 - 2 * static_cast<int>(s));
  }
  return result;
}

}  // namespace

Radau::Stages Radau::weights(Real place) const {
  Stages result{};
  for (std::size_t j = 1; j <= stages; ++j) {
    Real product = 1;
    for (std::size_t m = 1; m <= stages; ++m)
      if (m != j) product *= (place - nodes[m]) / (nodes[j] - nodes[m]);
    result[j - 1] = product;
  }
  return result;
}

const Radau& radau() {
  static const Radau result = make_radau();
  return result;
}

}  // namespace pwlsim::test::converters
