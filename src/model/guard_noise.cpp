#include "model/guard_noise.hpp"

#include <algorithm>

#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

using linalg::Matrix;
using linalg::Vector;

constexpr double error_factor = 10.0;  ///< what two answers differ by, as an error of each

/// Guards as rows of x.
Matrix guards_of_state(const Mode& mode) {
  Matrix rows(mode.guards.rows(), mode.basis.rows() + mode.ny - mode.n1);
  rows << mode.guards.leftCols(mode.n1) * mode.basis.transpose(), mode.guards.rightCols(mode.ny - mode.n1);
  return rows;
}

/// A row that is no larger, and has no digit in common with that at another shift, is zero: that of a port that blocks, or of a control, the current of an inductor behind
/// diodes that block, say.
double rounding_of_zero(const System& system, const Mode& mode, int row) {
  if (row < system.diodes) return mode.active.contains(row) ? 0.0 : tolerance::guard_row_rounding * system.c.row(row).norm();
  return tolerance::row_entry * system.controls[static_cast<std::size_t>(row - system.diodes) / 2].value.state.norm();
}

/// The row is zero: the port is indeterminate.
void leave_out_guard(Mode& mode, Eigen::Index row) {
  for (Matrix* m : {&mode.guards, &mode.absolute_guards, &mode.guard_block_norm}) m->row(row).setZero();
  mode.guard_norm[row] = mode.guard_c_norm[row] = 0.0;
  if (mode.scaled_guard_c_norm.size() > 0) mode.scaled_guard_c_norm[row] = 0.0;
  mode.guard_constant[static_cast<std::size_t>(row)] = 1;
}

}  // namespace

void measure_guard_noise(const System& system, Mode& mode, const Matrix& other) {
  const Matrix difference = error_factor * (guards_of_state(mode) - other);
  const Vector error = difference.rowwise().norm();
  const bool has_leaks = error.size() > 0 && (error.array() > tolerance::most_guard_noise * mode.guard_norm.array()).any();
  for (int i = 0; i < error.size(); ++i) {
    const double norm = mode.guard_norm[i];
    if (norm == 0.0) continue;
    if (error[i] >= norm && norm <= rounding_of_zero(system, mode, i))
      leave_out_guard(mode, i);
    else
      mode.guard_noise[i] = std::clamp(error[i] / norm, mode.noise, tolerance::largest_guard_noise);
  }
  if (!has_leaks) return;
  mode.guard_error.resize(mode.guards.rows(), mode.ny);
  mode.guard_error.leftCols(mode.n1) = (difference.leftCols(system.n) * mode.basis).cwiseAbs();
  mode.guard_error.rightCols(mode.ny - mode.n1) = difference.rightCols(mode.ny - mode.n1).cwiseAbs();
}

double guard_size(const Mode& mode, int row, const double* y, double share) {
  const double terms = linalg::absolute_row_times(mode.guards, row, y), norm = linalg::norm(y, mode.ny);
  if (!mode.apart) return std::max(terms, share * mode.guard_norm[row] * norm);
  double fast = 0.0;
  for (Eigen::Index j = 0; j < mode.apart->terms.rows(); ++j)
    fast += std::abs(mode.guards(row, mode.apart->first + j)) * linalg::absolute_row_times(mode.apart->terms, j, y);
  const double of_sources = mode.apart->source_guard_norm[row] * linalg::norm(y + mode.n1, mode.ny - mode.n1);
  return std::max({terms, share * (mode.apart->slow_guard_norm[row] * norm + of_sources), fast});
}

double guard_rounding(const Mode& mode, int row, const double* y, double size, double least) {
  const double noise = std::max(mode.guard_noise[row], least);
  if (mode.guard_error.size() == 0) return noise * size;
  return std::min(noise * size, std::max(mode.noise, least) * size + linalg::absolute_row_times(mode.guard_error, row, y));
}

}  // namespace pwlsim::model
