#include "model/mode_inputs.hpp"

#include <cmath>

#include "linalg/elimination.hpp"
#include "linalg/factorisations.hpp"
#include "linalg/refined_solution.hpp"
#include "model/subspaces.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

using linalg::absolute_product;
using linalg::product;
using linalg::wide_clean_product;
using linalg::wide_clean_sum;
using linalg::wide_cleaned;
using linalg::WideMatrix;
using linalg::WideVector;

/// Of D_JJ, from which on inputs share their rounding.
constexpr double bad_condition = 1e2;
/// From which on a solution is refined.
constexpr double very_bad_condition = 1e5;

/// Entries (i, j) that are rounding of row_size_i·column_size_j become zero.
void clean_against(WideMatrix& m, const WideVector& row_size, const WideVector& column_size) {
  for (Eigen::Index j = 0; j < m.cols(); ++j)
    for (Eigen::Index i = 0; i < m.rows(); ++i)
      if (std::abs(m(i, j)) <= linalg::wide_clean_tolerance * row_size[i] * column_size[j]) m(i, j) = 0.0;
}

}  // namespace

ModeInputs::ModeInputs(const System& system, const IndexSet& active) : s_(system), w_(system.unrounded_matrices()) {
  for (int i = 0; i < system.ports; ++i)
    if (active.contains(i)) r_.j.push_back(i);
}

void ModeInputs::restrict_matrices() {
  r_.b = linalg::columns_of(w_->b, r_.j);
  r_.c = linalg::rows_of(w_->c, r_.j);
  r_.d = linalg::columns_of(linalg::rows_of(w_->d, r_.j), r_.j);
}

bool ModeInputs::solve(Mode& mode) {
  restrict_matrices();
  const auto q = r_.d.rows();
  kj_ = WideMatrix::Zero(q, s_.size());
  constraints_ = WideMatrix(0, s_.size());
  if (q == 0) return true;
  const linalg::WideElimination quick(r_.d, tolerance::regular_block);
  if (quick.rank() == q) {
    take_inverse(quick.inverse());
    return true;
  }
  const linalg::CarefulElimination elimination = examine_feedthrough();
  if (elimination.rank() == q) {
    take_inverse(elimination.solve(WideMatrix::Identity(q, q)));
    return true;
  }
  return solve_with_kernel(elimination, mode) || solve_generally(elimination, mode);
}

linalg::CarefulElimination ModeInputs::examine_feedthrough() const {
  if (s_.unrounded) return {r_.d, {}, tolerance::entry_doubt * r_.d.cwiseAbs()};
  return {r_.d, {}, WideMatrix::Constant(r_.d.rows(), r_.d.cols(), tolerance::rounded_doubt)};
}

/// u_J = −D_JJ⁻¹ C_J x.
void ModeInputs::take_inverse(const WideMatrix& inverse) {
  kj_ = -product(inverse, r_.c);
  // Skeel's condition number: a diode with Ron beside one with Roff is badly scaled, not badly conditioned.
  condition_ = static_cast<double>(absolute_product(inverse, r_.d).rowwise().sum().maxCoeff());
  if (condition_ > very_bad_condition) kj_ = linalg::refined_solution(r_.d, WideMatrix::Zero(r_.d.rows(), r_.d.cols()), inverse, -r_.c);
  // |δK| ≤ ε|D⁻¹|(|D||K| + |C|): what lies within a few of that is zero.
  const WideMatrix bound = absolute_product(inverse, absolute_product(r_.d, kj_) + r_.c.cwiseAbs());
  kj_error_ = (s_.unrounded ? tolerance::wide_solution_noise : tolerance::solution_noise) * bound;
  for (Eigen::Index j = 0; j < kj_.cols(); ++j) leave_out_rounding(j, kj_error_.col(j));
}

/// Inputs that are rounding become zero. Where D is badly conditioned the same rounding is in the others: they are solved for without those.
void ModeInputs::leave_out_rounding(Eigen::Index column, const WideVector& rounding) {
  auto k = kj_.col(column);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < k.size(); ++i) {
    if (std::abs(k[i]) > rounding[i])
      kept.push_back(i);
    else
      k[i] = 0;
  }
  if (condition_ < bad_condition || kept.empty() || kept.size() == r_.j.size()) return;
  const WideMatrix columns = r_.d(Eigen::all, kept);
  k(kept) = -linalg::wide_least_squares(columns, r_.c.col(column));
}

ModeInputs::Kernel ModeInputs::kernel_of(const linalg::CarefulElimination& elimination) {
  if (elimination.rank() == 0) return {true, {}, r_.c, r_.b, {}, {}};
  Kernel kernel;
  kernel.right = elimination.kernel();
  const WideMatrix left = elimination.left_kernel();
  kj_ = -elimination.solve(r_.c);
  // An entry of a null vector is exact to the rounding of its largest.
  kernel.constraint = product(left.transpose(), r_.c);
  clean_against(kernel.constraint, left.cwiseAbs().colwise().maxCoeff(), r_.c.cwiseAbs().colwise().sum());
  kernel.jump = product(r_.b, kernel.right);
  clean_against(kernel.jump, r_.b.cwiseAbs().rowwise().sum(), kernel.right.cwiseAbs().colwise().maxCoeff());
  kernel.row_bound = absolute_product(left.transpose(), r_.c.leftCols(s_.n)).rowwise().norm();
  kernel.column_bound = absolute_product(r_.b, kernel.right).colwise().norm().transpose();
  return kernel;
}

/// Relative degree one on the kernel of D_JJ: constraint R x = 0 with R = N_lᵀ C_J, jumps along T = B_J N_r, R T regular.
bool ModeInputs::solve_with_kernel(const linalg::CarefulElimination& elimination, Mode& mode) {
  Kernel kernel = kernel_of(elimination);
  WideMatrix &right = kernel.right, &constraint = kernel.constraint, &jump = kernel.jump;
  const WideVector row_norm = constraint.leftCols(s_.n).rowwise().norm();
  const WideVector column_norm = jump.colwise().norm().transpose();
  const auto is_rounding = [&](const WideVector& norm, const WideVector& bound) {
    return (norm.array() <= tolerance::cancelled_norm * (kernel.is_all ? norm : bound).array()).any();
  };
  if (s_.n == 0 || is_rounding(row_norm, kernel.row_bound) || is_rounding(column_norm, kernel.column_bound)) return false;
  constraint.array().colwise() /= row_norm.array();
  jump.array().rowwise() /= column_norm.transpose().array();
  const linalg::WideElimination gain(product(constraint, jump), tolerance::jump_rank);
  if (gain.rank() < constraint.rows()) return false;
  condition_ = std::max(condition_, static_cast<double>(gain.largest_pivot() / gain.smallest_pivot()));
  const WideMatrix inverse = gain.inverse();
  if (kernel.is_all) {
    const WideMatrix bound = absolute_product(inverse, absolute_product(constraint, w_->a));
    kj_ = wide_cleaned(-product(inverse, product(constraint, w_->a)), bound);
    kj_.array().colwise() /= column_norm.array();
  } else {
    right.array().rowwise() /= column_norm.transpose().array();
    const WideMatrix rate = w_->a + product(r_.b, kj_);
    WideMatrix bound = w_->a.cwiseAbs() + absolute_product(r_.b, kj_);
    bound = absolute_product(right, absolute_product(inverse, absolute_product(constraint, bound))) + kj_.cwiseAbs();
    kj_ = wide_cleaned(kj_ - product(right, product(inverse, product(constraint, rate))), bound);
  }
  WideMatrix projector = -product(jump, product(inverse, constraint));
  projector.diagonal().array() += 1;
  mode.projector = projector.cast<double>();
  constraints_ = std::move(constraint);
  return true;
}

/// D_JJ is solved for first, u_J = K₀ x + N_r w with N_lᵀ C_J x = 0: what remains has no feedthrough, and no rank of it depends on sizes in D.
bool ModeInputs::solve_generally(const linalg::CarefulElimination& elimination, Mode& mode) {
  const WideMatrix right = elimination.kernel(), left = elimination.left_kernel();
  kj_ = -elimination.solve(r_.c);
  WideMatrix jump = product(r_.b, right), constraint = product(left.transpose(), r_.c);
  clean_against(jump, r_.b.cwiseAbs().rowwise().sum(), right.cwiseAbs().colwise().maxCoeff());
  clean_against(constraint, left.cwiseAbs().colwise().maxCoeff(), r_.c.cwiseAbs().colwise().sum());
  const WideMatrix rate = wide_clean_sum(w_->a, r_.b, kj_);
  const Subspaces subspaces = find_subspaces(rate, jump, constraint, WideMatrix::Zero(constraint.rows(), jump.cols()), s_.n_zeta);
  if (!subspaces.regular) return false;
  mode.projector = subspaces.projector.cast<double>();
  kj_ = wide_clean_sum(kj_, right, subspaces.feedback);
  constraints_ = subspaces.constraints;
  condition_ = subspaces.condition;
  if (subspaces.free_inputs.cols() > 0) take_least_norm(wide_clean_product(right, subspaces.free_inputs), mode);
  return true;
}

/// Inputs are free along Y = ker [B_J; D_JJ]; what they move is (u_J, D·u_J), and the least norm of all of it is taken: parallel diodes share their current.
/// Returns what is moved.
WideMatrix ModeInputs::share_by_least_norm(const WideMatrix& free_directions) {
  WideMatrix d_columns(s_.ports, static_cast<Eigen::Index>(r_.j.size()));
  for (std::size_t a = 0; a < r_.j.size(); ++a) d_columns.col(static_cast<Eigen::Index>(a)) = w_->d.col(r_.j[a]);
  const auto q = kj_.rows();
  WideMatrix moved(q + s_.ports, free_directions.cols());
  moved << free_directions, wide_clean_product(d_columns, free_directions);
  WideMatrix base(q + s_.ports, s_.size());
  base << kj_, w_->c + d_columns * kj_;
  kj_ -= free_directions * (linalg::wide_pseudo_inverse(moved, tolerance::free_input_rank) * base);
  return moved;
}

void ModeInputs::take_least_norm(const WideMatrix& free_directions, Mode& mode) {
  mode.unique_inputs = false;
  mode.free_inputs = Matrix::Zero(s_.ports, free_directions.cols());
  for (std::size_t a = 0; a < r_.j.size(); ++a)
    mode.free_inputs.row(r_.j[a]) = free_directions.row(static_cast<Eigen::Index>(a)).cast<double>();
  const WideMatrix moved = share_by_least_norm(free_directions);
  for (std::size_t a = 0; a < r_.j.size(); ++a)
    if (free_directions.row(static_cast<Eigen::Index>(a)).cwiseAbs().maxCoeff() > tolerance::free_input_entry)
      mode.input_unique[static_cast<std::size_t>(r_.j[a])] = 0;
  for (int i = 0; i < s_.ports; ++i)
    if (moved.row(kj_.rows() + i).cwiseAbs().maxCoeff() > tolerance::free_input_entry) mode.input_unique[static_cast<std::size_t>(i)] = 0;
}

void ModeInputs::take(const SlowManifold& manifold, Mode& mode) {
  kj_ = manifold.feedback;
  constraints_ = manifold.constraints;
  if (manifold.free_inputs.cols() > 0) take_least_norm(manifold.free_inputs, mode);
  mode.projector = manifold.projector.cast<double>();
}

void ModeInputs::take(Feedback& feedback) {
  kj_ = std::move(feedback.inputs);
  if (feedback.free_inputs.cols() > 0) share_by_least_norm(feedback.free_inputs);
}

}  // namespace pwlsim::model
