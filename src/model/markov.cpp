#include "model/markov.hpp"

#include <algorithm>
#include <cmath>

#include "model/certificate.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

using linalg::Matrix;

bool is_zero(const Matrix& m) { return m.size() == 0 || m.cwiseAbs().maxCoeff() == 0.0; }

bool is_regular(Matrix m) {
  for (auto row : m.rowwise()) row.normalize();
  for (auto column : m.colwise()) column.normalize();
  return linalg::null_space(m, tolerance::rank).cols() == 0;
}

/// Takes one parameter into the degrees and the leading rows and columns; whether a row or a column is led by it.
bool take(Markov& result, const Matrix& parameter, int order) {
  bool leads = false;
  const auto count = parameter.rows();
  for (Eigen::Index i = 0; i < count; ++i) {
    if (is_zero(result.leading_rows.row(i)) && !is_zero(parameter.row(i))) {
      result.leading_rows.row(i) = parameter.row(i);
      leads = true;
    }
    if (is_zero(result.leading_columns.col(i)) && !is_zero(parameter.col(i))) {
      result.leading_columns.col(i) = parameter.col(i);
      leads = true;
    }
    for (Eigen::Index j = 0; j < count; ++j)
      if (int& degree = result.degree[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]; degree < 0 && parameter(i, j) != 0.0)
        degree = order;
  }
  return leads;
}

bool all_known(const std::vector<std::vector<int>>& degree) {
  return std::all_of(degree.begin(), degree.end(), [](const auto& row) { return std::find(row.begin(), row.end(), -1) == row.end(); });
}

}  // namespace

Markov markov_parameters(const Matrix& a, const Matrix& b, const Matrix& c, const Matrix& d) {
  const auto k = d.rows();
  Markov result;
  result.leading_rows = result.leading_columns = Matrix::Zero(k, k);
  result.degree.assign(static_cast<std::size_t>(k), std::vector<int>(static_cast<std::size_t>(k), -1));
  // Powers of A/‖A‖ stay in range, whatever their order.
  const double rate = linalg::rate_of(a);
  const Matrix scaled = a / rate;
  std::size_t kept = 1;
  Matrix power = b;
  // By Cayley–Hamilton an entry that is zero up to order n is zero at every order.
  for (int order = 0; order <= static_cast<int>(a.rows()) && (order == 0 || !all_known(result.degree)); ++order) {
    if (order > 1) power = linalg::clean_product(scaled, power);
    result.parameters.push_back(order == 0 ? d : linalg::clean_product(c, power));
    if (take(result, result.parameters.back(), order)) kept = result.parameters.size();
  }
  const auto leading = std::find_if_not(result.parameters.begin(), result.parameters.end(), is_zero);
  if (k > 0 && leading != result.parameters.end() && is_regular(*leading))
    result.uniform_degree = static_cast<int>(leading - result.parameters.begin());
  result.parameters.resize(kept);
  for (std::size_t order = 2; order < kept; ++order) result.parameters[order] *= std::pow(rate, static_cast<double>(order) - 1.0);
  return result;
}

bool has_positive_leading_minors(const Markov& markov) {
  return has_positive_principal_minors(markov.leading_rows) || has_positive_principal_minors(markov.leading_columns);
}

}  // namespace pwlsim::model
