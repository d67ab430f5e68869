#include "linalg/refined_solution.hpp"

#include <vector>

#include "linalg/doubled.hpp"
#include "linalg/tolerances.hpp"

namespace pwlsim::linalg {

namespace {

constexpr int refinements = 3;  ///< each multiplies the error by ε·cond(G)
struct Entry {
  Eigen::Index column = 0;
  Wide value = 0, rest = 0;
};

std::vector<std::vector<Entry>> rows_of(const WideMatrix& g, const WideMatrix& rest) {
  std::vector<std::vector<Entry>> rows(static_cast<std::size_t>(g.rows()));
  for (Eigen::Index i = 0; i < g.rows(); ++i)
    for (Eigen::Index j = 0; j < g.cols(); ++j)
      if (g(i, j) != 0) rows[static_cast<std::size_t>(i)].push_back({j, g(i, j), rest(i, j)});
  return rows;
}

}  // namespace

WideMatrix refined_solution(const WideMatrix& g, const WideMatrix& g_rest, const WideMatrix& inverse, const WideMatrix& right) {
  const auto rows = rows_of(g, g_rest);
  WideMatrix x = sparse_product(inverse, right);
  WideMatrix residual(right.rows(), right.cols());
  for (int round = 0; round < refinements; ++round) {
    for (Eigen::Index j = 0; j < right.cols(); ++j)
      for (Eigen::Index i = 0; i < right.rows(); ++i) {
        Doubled sum{right(i, j), 0};
        for (const Entry& entry : rows[static_cast<std::size_t>(i)]) {
          sum.add_product(-entry.value, x(entry.column, j));
          sum.rest -= entry.rest * x(entry.column, j);
        }
        residual(i, j) = sum.value + sum.rest;
      }
    x += product(inverse, residual);
  }
  const WideMatrix unsure = absolute_product(inverse, residual);
  return (unsure.array() > tolerance::unsettled_entry * x.array().abs()).select(WideMatrix::Zero(x.rows(), x.cols()), x);
}

}  // namespace pwlsim::linalg
