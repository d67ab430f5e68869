#include "model/port_problem.hpp"

#include "lcp/lemke.hpp"
#include "linalg/factorisations.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

using linalg::Matrix;
using linalg::Vector;

}  // namespace

PortProblem without_switches(const PortProblem& problem, int diodes, const std::vector<int>& active) {
  const Eigen::Index d = diodes;
  const auto a = static_cast<Eigen::Index>(active.size());
  PortProblem reduced{problem.m.topLeftCorner(d, d), problem.q.head(d)};
  if (a == 0) return reduced;
  Matrix ss(a, a), sd(a, d), ds(d, a);
  Vector qs(a);
  for (Eigen::Index i = 0; i < a; ++i) {
    const int port = active[static_cast<std::size_t>(i)];
    qs[i] = problem.q[port];
    sd.row(i) = problem.m.row(port).head(d);
    ds.col(i) = problem.m.col(port).head(d);
    for (Eigen::Index j = 0; j < a; ++j) ss(i, j) = problem.m(port, active[static_cast<std::size_t>(j)]);
  }
  const Vector scale = lcp::diagonal_scale(ss);
  const Matrix scaled = scale.asDiagonal() * ss * scale.asDiagonal();
  Eigen::FullPivLU<Matrix> lu(scaled);
  lu.setThreshold(tolerance::switch_rank);
  if (!lu.isInvertible()) {
    PortProblem split{Matrix(d + 2 * a, d + 2 * a), Vector(d + 2 * a)};
    split.m << reduced.m, ds, -ds, sd, ss, -ss, -sd, -ss, ss;
    split.q << reduced.q, qs, -qs;
    return split;
  }
  // A Schur complement cancels: what is left of equal terms is rounding, and must not decide.
  const Matrix to = ds * scale.asDiagonal();
  const Matrix inverse = lu.inverse();
  const Matrix left = to * inverse;
  const Matrix left_bound = to.cwiseAbs() * inverse.cwiseAbs();
  const Matrix right = scale.asDiagonal() * sd;
  const Vector right_q = scale.asDiagonal() * qs;
  reduced.m = linalg::cleaned(reduced.m - left * right, reduced.m.cwiseAbs() + left_bound * right.cwiseAbs());
  reduced.q = linalg::cleaned(reduced.q - left * right_q, reduced.q.cwiseAbs() + left_bound * right_q.cwiseAbs());
  return reduced;
}

}  // namespace pwlsim::model
