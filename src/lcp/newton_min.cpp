#include "lcp/newton_min.hpp"

#include <algorithm>
#include <set>

#include "lcp/tolerances.hpp"

namespace pwlsim::lcp {

namespace {

using linalg::Matrix;
using linalg::Vector;

/// Indices of the basis with z ≥ 0 and others with w < 0.
std::vector<int> next_set(const Solution& at, const Vector& q) {
  const double level_z = tolerance::sign * at.z.cwiseAbs().maxCoeff();
  const double level_w = tolerance::sign * std::max(q.cwiseAbs().maxCoeff(), at.w.cwiseAbs().maxCoeff());
  std::vector<int> set;
  auto basic = at.basis.begin();
  for (int i = 0; i < static_cast<int>(q.size()); ++i) {
    const bool in_basis = basic != at.basis.end() && *basic == i;
    if (in_basis) ++basic;
    if (in_basis ? at.z[i] >= -level_z : at.w[i] < -level_w) set.push_back(i);
  }
  return set;
}

}  // namespace

Solution newton_min(const Matrix& m, const Vector& q, const std::vector<int>& start) {
  if (q.size() == 0) return {Status::solved, q, q, {}, 0};
  std::set<std::vector<int>> visited;
  std::vector<int> set = start;
  std::sort(set.begin(), set.end());
  const int limit = static_cast<int>(q.size()) + 10;
  for (int steps = 1; steps <= limit; ++steps) {
    if (!visited.insert(set).second) return {Status::cycle, Vector::Zero(q.size()), q, {}, steps};
    Solution at = at_basis(m, q, set);
    at.pivots = steps;
    if (at.status != Status::solved) return at;
    set = next_set(at, q);
    if (set == at.basis) return at;
  }
  return {Status::pivot_limit, Vector::Zero(q.size()), q, {}, limit};
}

}  // namespace pwlsim::lcp
