#include "model/random_systems.hpp"

#include <numeric>

namespace pwlsim::test {

namespace {

using linalg::Matrix;
using linalg::Vector;

constexpr int most_chain_states = 6;
constexpr int most_ports = 4;
constexpr int largest_degree = 3;

}  // namespace

/// Symmetric positive definite, dominant (P), or anything.
Matrix SystemMaker::leading(int k) {
  const int kind = below(3);
  if (kind == 0) {
    const Matrix g = matrix(k, k, 1);
    return g * g.transpose() + Matrix::Identity(k, k);
  }
  Matrix m = matrix(k, k);
  if (kind == 1)
    for (int i = 0; i < k; ++i) m(i, i) = m.row(i).cwiseAbs().sum() - std::abs(m(i, i)) + 1.0;
  for (int i = 0; i < k; ++i)
    if (m.row(i).isZero(0.0)) m(i, below(k)) = 1.0;
  return m;
}

std::vector<int> SystemMaker::draw_degrees(int k) {
  std::vector<int> degrees(static_cast<std::size_t>(k));
  do {
    const bool uniform = below(2) == 0;
    for (int& d : degrees) d = uniform && &d != degrees.data() ? degrees[0] : below(largest_degree + 1);
  } while (std::accumulate(degrees.begin(), degrees.end(), 0) > most_chain_states);
  return degrees;
}

RandomSystem SystemMaker::of_chains() {
  const int k = 1 + below(most_ports);
  RandomSystem r;
  r.degrees = draw_degrees(k);
  const int chains = std::accumulate(r.degrees.begin(), r.degrees.end(), 0);
  const int n = std::max(1, chains + below(3));
  const Matrix top = leading(k);
  auto& s = r.system;
  s.a = Matrix::Zero(n, n);
  s.b = Matrix::Zero(n, k);
  s.c = Matrix::Zero(k, n);
  s.d = Matrix::Zero(k, k);
  r.x = Vector::Zero(n);
  int first = 0;
  for (int i = 0; i < k; ++i) {
    const int degree = r.degrees[static_cast<std::size_t>(i)];
    if (degree == 0) {
      s.c.row(i) = matrix(1, n);
      s.d.row(i) = top.row(i);
      continue;
    }
    s.c(i, first) = 1.0;
    for (int j = 0; j + 1 < degree; ++j) s.a(first + j, first + j + 1) = 1.0;
    s.a.row(first + degree - 1) = matrix(1, n);
    s.b.row(first + degree - 1) = top.row(i);
    // Most states touch their bounds, some are inconsistent.
    const bool at_bound = below(4) > 0;
    for (int j = 0; j < degree; ++j) r.x[first + j] = at_bound && j == 0 ? 0.0 : entry();
    if (below(2) == 0) r.x.segment(first, degree) = r.x.segment(first, degree).cwiseMax(0.0);
    first += degree;
  }
  for (int j = chains; j < n; ++j) {
    s.a.row(j) = matrix(1, n);
    if (below(3) == 0) s.b.row(j) = matrix(1, k, 1);
    r.x[j] = entry();
  }
  mix_coordinates(r);
  return r;
}

/// x → T x with T unit lower triangular of zeros and ones, one entry below the diagonal.
void SystemMaker::mix_coordinates(RandomSystem& r) {
  const int n = r.system.n();
  if (n < 2) return;
  const int row = 1 + below(n - 1);
  const int column = below(row);
  Matrix t = Matrix::Identity(n, n), inverse = Matrix::Identity(n, n);
  t(row, column) = 1.0;
  inverse(row, column) = -1.0;
  r.system.a = t * r.system.a * inverse;
  r.system.b = t * r.system.b;
  r.system.c = r.system.c * inverse;
  r.x = t * r.x;
}

RandomSystem SystemMaker::unstructured() {
  const int k = 1 + below(3);
  const int n = 1 + below(4);
  RandomSystem r;
  r.system = {matrix(n, n, 1), matrix(n, k, 1), matrix(k, n, 1), below(2) == 0 ? Matrix(Matrix::Zero(k, k)) : matrix(k, k, 1)};
  r.x = Vector::NullaryExpr(n, [&] { return static_cast<double>(entry()); });
  return r;
}

}  // namespace pwlsim::test
