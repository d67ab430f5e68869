#include "lcp/problem_classes.hpp"

namespace pwlsim::test {
namespace {

using linalg::Matrix;
using linalg::Vector;

Vector any_right(Problems& random, const Matrix& m) { return random.vector(static_cast<int>(m.rows())); }

Matrix p_matrix(Problems& random, int k) {
  if (k > 3) {  // rare among random matrices: dominant rows
    Matrix dominant = random.matrix(k, k);
    for (int i = 0; i < k; ++i) dominant(i, i) = 1.05 * (dominant.row(i).cwiseAbs().sum() - std::abs(dominant(i, i)));
    return dominant;
  }
  for (;;) {
    const Matrix m = random.matrix(k, k) + 0.5 * Matrix::Identity(k, k);
    if (is_p_matrix(m)) return m;
  }
}

/// Diodes between nodes of a resistive network, z their currents and w their blocking voltages: w = Eᵀ G⁻¹ (E z − J), E the incidence of diodes,
/// G the conductances, J the sources. More diodes than nodes, some in parallel: singular. Infeasible never: a λ ≥ 0 with M λ = 0 has E λ = 0 and
/// so qᵀλ = 0.
struct DiodeNetwork {
  Matrix e, resistance;

  DiodeNetwork(Problems& random, int k) {
    const int nodes = 1 + k / 2;
    e = Matrix::Zero(nodes, k);
    for (int j = 0; j < k; ++j) {
      if (j > 0 && random.number() > 0.4) {
        e.col(j) = (random.number() > 0.0 ? 1.0 : -1.0) * e.col(random.below(j));
        continue;
      }
      const int from = random.below(nodes);
      const int to = random.below(nodes + 1);
      e(from, j) = 1.0;
      if (to < nodes && to != from) e(to, j) = -1.0;
    }
    const Matrix branches = random.matrix(nodes, nodes);
    resistance = branches * branches.transpose() + 0.3 * Matrix::Identity(nodes, nodes);
  }
  [[nodiscard]] Matrix m() const { return e.transpose() * resistance * e; }
};

/// Rows in the range of M: what sources in the network make.
Vector right_of_sources(Problems& random, const Matrix& m) { return -(m * random.vector(static_cast<int>(m.rows()))); }

Matrix m_matrix(Problems& random, int k) {
  Matrix m = -random.matrix(k, k).cwiseAbs();
  for (int i = 0; i < k; ++i) m(i, i) = 0.02 - (m.row(i).sum() - m(i, i));
  return m;
}

Matrix near_skew(Problems& random, int k) {
  const Matrix s = random.matrix(k, k);
  return s - s.transpose() + 1e-6 * Matrix::Identity(k, k);
}

Matrix positive_definite(Problems& random, int k) { return random.semidefinite(k, k) + 0.05 * Matrix::Identity(k, k); }

Matrix low_rank(Problems& random, int k) {
  const Matrix g = random.matrix(k, 1);
  return g * g.transpose();
}

Matrix copositive(Problems& random, int k) { return random.matrix(k, k).cwiseAbs() + 0.1 * Matrix::Identity(k, k); }

}  // namespace

Vector feasible_right(Problems& random, const Matrix& m) {
  const auto k = static_cast<int>(m.rows());
  const Vector z = random.vector(k).cwiseMax(0.0);
  return random.vector(k).cwiseMax(0.0) - m * z;
}

const std::vector<ProblemClass>& problem_classes() {
  static const std::vector<ProblemClass> all = {
      {"P", by_lemke | by_least_index, p_matrix, any_right},
      {"positive definite", by_lemke | by_least_index, positive_definite, any_right},
      {"semidefinite, feasible", by_lemke, [](Problems& r, int k) { return r.semidefinite(k, (k + 1) / 2); }, feasible_right},
      {"semidefinite, any", by_lemke, low_rank, any_right},
      {"diodes in parallel and in rings", by_lemke, [](Problems& r, int k) { return DiodeNetwork(r, k).m(); }, right_of_sources},
      {"M", by_lemke | by_newton | by_least_index, m_matrix, any_right},
      {"near-skew", by_lemke | by_least_index, near_skew, any_right},
      {"strictly copositive", by_lemke, copositive, any_right},
      {"any", 0, [](Problems& r, int k) { return r.matrix(k, k); }, any_right},
  };
  return all;
}

}  // namespace pwlsim::test
