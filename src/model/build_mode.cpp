#include "model/build_mode.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "linalg/careful_elimination.hpp"
#include "linalg/constraint_basis.hpp"
#include "linalg/elimination.hpp"
#include "linalg/refined_solution.hpp"
#include "model/guard_noise.hpp"
#include "model/modal_form.hpp"
#include "model/subspaces.hpp"
#include "model/tolerances.hpp"
#include "model/valves.hpp"

namespace pwlsim::model {

namespace {

using linalg::absolute_product;
using linalg::product;
using linalg::Wide;
using linalg::wide_clean_product;
using linalg::wide_clean_sum;
using linalg::wide_cleaned;
using linalg::WideMatrix;
using linalg::WideVector;

/// Of D_JJ, from which on inputs share their rounding.
constexpr double bad_condition = 1e2;
/// From which on a solution is refined.
constexpr double very_bad_condition = 1e5;
/// Of A, 1/s: its square has to be a number.
constexpr double fastest_rate = 1e150;

struct Restricted {
  std::vector<int> j;
  WideMatrix b, c, d;
};

Restricted restrict_to(const Unrounded& s, const IndexSet& active) {
  Restricted r;
  for (int i = 0; i < static_cast<int>(s.d.rows()); ++i)
    if (active.contains(i)) r.j.push_back(i);
  const auto q = static_cast<Eigen::Index>(r.j.size());
  r.b.resize(s.b.rows(), q);
  r.c.resize(q, s.c.cols());
  r.d.resize(q, q);
  // Loops: views by index cost as much as three products here.
  for (Eigen::Index a = 0; a < q; ++a) {
    const Eigen::Index j = r.j[static_cast<std::size_t>(a)];
    for (Eigen::Index i = 0; i < r.b.rows(); ++i) r.b(i, a) = s.b(i, j);
    for (Eigen::Index i = 0; i < r.c.cols(); ++i) r.c(a, i) = s.c(j, i);
    for (Eigen::Index b = 0; b < q; ++b) r.d(a, b) = s.d(j, r.j[static_cast<std::size_t>(b)]);
  }
  return r;
}

/// Entries (i, j) that are rounding of row_size_i·column_size_j become zero.
void clean_against(WideMatrix& m, const WideVector& row_size, const WideVector& column_size) {
  for (Eigen::Index j = 0; j < m.cols(); ++j)
    for (Eigen::Index i = 0; i < m.rows(); ++i)
      if (std::abs(m(i, j)) <= linalg::wide_clean_tolerance * row_size[i] * column_size[j]) m(i, j) = 0.0;
}

class Builder {
 public:
  Builder(const System& system, const IndexSet& active) : s_(system), w_(system.unrounded_matrices()), r_(restrict_to(*w_, active)) {
    noise_per_condition_ = system.unrounded ? tolerance::wide_noise_per_condition : tolerance::noise_per_condition;
    mode_ = std::make_unique<Mode>();
    mode_->active = active;
    mode_->input_unique.assign(static_cast<std::size_t>(system.ports), 1);
  }

  std::unique_ptr<Mode> run() {
    mode_->regular = solve_inputs();
    return finish();
  }

  /// Null where the mode leaves no fast decays.
  std::unique_ptr<Mode> run_slow(const Mode& whole, const Rates& rates, ShiftedSystems& shifted, double longest) {
    manifold_ = slow_manifold(s_, whole, rates, r_.j, shifted, longest);
    if (!manifold_) return nullptr;
    mode_->regular = true;
    take_manifold();
    auto mode = finish();
    if (!mode->regular) return nullptr;
    add_decays(whole, *mode);
    if (const std::optional<Matrix> guards = guards_at_other_shift(*mode, shifted)) measure_guard_noise(s_, *mode, *guards);
    return mode;
  }

 private:
  std::unique_ptr<Mode> finish() {
    if (!mode_->regular) return std::move(mode_);
    mode_->noise = std::max(tolerance::noise_floor, noise_per_condition_ * condition_);
    spread_inputs();
    reduce_coordinates();
    mode_->regular = build_flow();
    if (mode_->regular) build_rows();
    return std::move(mode_);
  }

  bool solve_inputs();
  void take_manifold();
  void take_inputs(const WideMatrix& inverse);
  void leave_out_rounding(Eigen::Index column, const WideVector& rounding);
  [[nodiscard]] linalg::CarefulElimination examine_feedthrough() const;
  bool solve_with_kernel(const linalg::CarefulElimination& elimination);
  bool solve_generally(const linalg::CarefulElimination& elimination);
  WideMatrix share_by_least_norm(const WideMatrix& free_directions);
  void take_least_norm(const WideMatrix& free_directions);
  void spread_inputs();
  void reduce_coordinates();
  bool build_flow();
  [[nodiscard]] Matrix mode_rows(const Mode& m);
  [[nodiscard]] Matrix guards_of(const Mode& m, const Matrix& rows) const;
  [[nodiscard]] std::optional<Matrix> guards_at_other_shift(const Mode& m, ShiftedSystems& shifted);
  void build_rows();
  void add_decays(const Mode& whole, Mode& slow) const;
  template <class Input>
  void add_inputs(WideMatrix& rows, Eigen::Index row, const Input& input, Wide rounding);
  void take_port_rows(const Mode& m, WideMatrix& rows) const;
  void clean_control_rows(Matrix& rows) const;
  [[nodiscard]] Matrix in_mode(const Mode& m, const WideMatrix& full) const;
  void bound_guard_noise() const;

  const System& s_;
  std::shared_ptr<const Unrounded> w_;
  Restricted r_;
  std::unique_ptr<Mode> mode_;
  WideMatrix kj_;           ///< u_J = kj·x
  WideMatrix kj_error_;     ///< a bound of what rounding of D_JJ and C_J makes of its entries; empty where that is not known
  WideMatrix constraints_;  ///< rows spanning the complement of V
  WideVector input_;        ///< of the active ports into the row at hand
  bool sources_constrain_ = false;
  WideMatrix embedding_;  ///< x = embedding·y, unrounded: [N R; 0 1]
  std::optional<SlowManifold> manifold_;
  double noise_per_condition_ = 0.0;
  double condition_ = 1.0;
  Matrix flow_;  ///< of y' = A y
};

bool Builder::solve_inputs() {
  const auto q = r_.d.rows();
  kj_ = WideMatrix::Zero(q, s_.size());
  constraints_ = WideMatrix(0, s_.size());
  if (q == 0) return true;
  const linalg::WideElimination quick(r_.d, tolerance::regular_block);
  if (quick.rank() == q) {
    take_inputs(quick.inverse());
    return true;
  }
  const linalg::CarefulElimination elimination = examine_feedthrough();
  if (elimination.rank() == q) {
    take_inputs(elimination.solve(WideMatrix::Identity(q, q)));
    return true;
  }
  return solve_with_kernel(elimination) || solve_generally(elimination);
}

linalg::CarefulElimination Builder::examine_feedthrough() const {
  if (s_.unrounded) return {r_.d, {}, tolerance::entry_doubt * r_.d.cwiseAbs()};
  return {r_.d, {}, WideMatrix::Constant(r_.d.rows(), r_.d.cols(), tolerance::rounded_doubt)};
}

/// u_J = −D_JJ⁻¹ C_J x.
void Builder::take_inputs(const WideMatrix& inverse) {
  kj_ = -product(inverse, r_.c);
  // Skeel's condition number: a diode with Ron beside one with Roff is badly scaled, not badly conditioned.
  condition_ = static_cast<double>(absolute_product(inverse, r_.d).rowwise().sum().maxCoeff());
  if (condition_ > very_bad_condition) kj_ = linalg::refined_solution(r_.d, WideMatrix::Zero(r_.d.rows(), r_.d.cols()), inverse, -r_.c);
  // |δK| ≤ ε|D⁻¹|(|D||K| + |C|): what lies within a few of that is zero.
  const WideMatrix bound = absolute_product(inverse, absolute_product(r_.d, kj_) + r_.c.cwiseAbs());
  kj_error_ = (s_.unrounded ? tolerance::wide_solution_noise : tolerance::solution_noise) * bound;
  for (Eigen::Index j = 0; j < kj_.cols(); ++j) leave_out_rounding(j, kj_error_.col(j));
}

void Builder::take_manifold() {
  kj_ = manifold_->feedback;
  constraints_ = manifold_->constraints;
  if (manifold_->free_inputs.cols() > 0) take_least_norm(manifold_->free_inputs);
  mode_->projector = manifold_->projector.cast<double>();
}

/// Inputs that are rounding become zero. Where D is badly conditioned the same rounding is in the others: they are solved for without those.
void Builder::leave_out_rounding(Eigen::Index column, const WideVector& rounding) {
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
  k(kept) = -Eigen::ColPivHouseholderQR<WideMatrix>(columns).solve(r_.c.col(column));
}

/// Relative degree one on the kernel of D_JJ: constraint R x = 0 with R = N_lᵀ C_J, jumps along T = B_J N_r, R T regular.
bool Builder::solve_with_kernel(const linalg::CarefulElimination& elimination) {
  const bool zero = elimination.rank() == 0;  // D_JJ: its kernel is everything
  WideMatrix right, constraint, jump;
  WideVector row_bound, column_bound;
  if (zero) {
    constraint = r_.c;
    jump = r_.b;
  } else {
    right = elimination.kernel();
    const WideMatrix left = elimination.left_kernel();
    kj_ = -elimination.solve(r_.c);
    // An entry of a null vector is exact to the rounding of its largest.
    constraint = product(left.transpose(), r_.c);
    clean_against(constraint, left.cwiseAbs().colwise().maxCoeff(), r_.c.cwiseAbs().colwise().sum());
    jump = product(r_.b, right);
    clean_against(jump, r_.b.cwiseAbs().rowwise().sum(), right.cwiseAbs().colwise().maxCoeff());
    row_bound = absolute_product(left.transpose(), r_.c.leftCols(s_.n)).rowwise().norm();
    column_bound = absolute_product(r_.b, right).colwise().norm().transpose();
  }
  const WideVector row_norm = constraint.leftCols(s_.n).rowwise().norm();
  const WideVector column_norm = jump.colwise().norm().transpose();
  const auto is_rounding = [&](const WideVector& norm, const WideVector& bound) {
    return (norm.array() <= tolerance::cancelled_norm * (zero ? norm : bound).array()).any();
  };
  if (s_.n == 0 || is_rounding(row_norm, row_bound) || is_rounding(column_norm, column_bound)) return false;
  constraint.array().colwise() /= row_norm.array();
  jump.array().rowwise() /= column_norm.transpose().array();
  const linalg::WideElimination gain(product(constraint, jump), tolerance::jump_rank);
  if (gain.rank() < constraint.rows()) return false;
  condition_ = std::max(condition_, static_cast<double>(gain.largest_pivot() / gain.smallest_pivot()));
  const WideMatrix inverse = gain.inverse();
  if (zero) {
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
  mode_->projector = projector.cast<double>();
  constraints_ = std::move(constraint);
  return true;
}

/// D_JJ is solved for first, u_J = K₀ x + N_r w with N_lᵀ C_J x = 0: what remains has no feedthrough, and no rank of it depends on sizes in D.
bool Builder::solve_generally(const linalg::CarefulElimination& elimination) {
  const WideMatrix right = elimination.kernel(), left = elimination.left_kernel();
  kj_ = -elimination.solve(r_.c);
  WideMatrix jump = product(r_.b, right), constraint = product(left.transpose(), r_.c);
  clean_against(jump, r_.b.cwiseAbs().rowwise().sum(), right.cwiseAbs().colwise().maxCoeff());
  clean_against(constraint, left.cwiseAbs().colwise().maxCoeff(), r_.c.cwiseAbs().colwise().sum());
  const WideMatrix rate = wide_clean_sum(w_->a, r_.b, kj_);
  const Subspaces subspaces = find_subspaces(rate, jump, constraint, WideMatrix::Zero(constraint.rows(), jump.cols()), s_.n_zeta);
  if (!subspaces.regular) return false;
  mode_->projector = subspaces.projector.cast<double>();
  kj_ = wide_clean_sum(kj_, right, subspaces.feedback);
  constraints_ = subspaces.constraints;
  condition_ = subspaces.condition;
  if (subspaces.free_inputs.cols() > 0) take_least_norm(wide_clean_product(right, subspaces.free_inputs));
  return true;
}

/// Inputs are free along Y = ker [B_J; D_JJ]; what they move is (u_J, D·u_J), and the least norm of all of it is taken: parallel diodes share their current.
/// Returns what is moved.
WideMatrix Builder::share_by_least_norm(const WideMatrix& free_directions) {
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

void Builder::take_least_norm(const WideMatrix& free_directions) {
  mode_->unique_inputs = false;
  mode_->free_inputs = Matrix::Zero(s_.ports, free_directions.cols());
  for (std::size_t a = 0; a < r_.j.size(); ++a)
    mode_->free_inputs.row(r_.j[a]) = free_directions.row(static_cast<Eigen::Index>(a)).cast<double>();
  const WideMatrix moved = share_by_least_norm(free_directions);
  for (std::size_t a = 0; a < r_.j.size(); ++a)
    if (free_directions.row(static_cast<Eigen::Index>(a)).cwiseAbs().maxCoeff() > tolerance::free_input_entry)
      mode_->input_unique[static_cast<std::size_t>(r_.j[a])] = 0;
  for (int i = 0; i < s_.ports; ++i)
    if (moved.row(kj_.rows() + i).cwiseAbs().maxCoeff() > tolerance::free_input_entry) mode_->input_unique[static_cast<std::size_t>(i)] = 0;
}

void Builder::spread_inputs() {
  mode_->k = Matrix::Zero(s_.ports, s_.size());
  for (std::size_t a = 0; a < r_.j.size(); ++a) mode_->k.row(r_.j[a]) = kj_.row(static_cast<Eigen::Index>(a)).cast<double>();
}

void Builder::reduce_coordinates() {
  Mode& m = *mode_;
  const auto fixed = static_cast<int>(constraints_.rows());
  m.constrained = fixed > 0;
  m.n1 = s_.n - fixed;
  m.ny = m.n1 + s_.n_zeta;
  if (!m.constrained) return;
  const linalg::ConstraintBasis free(constraints_.leftCols(s_.n));
  const WideMatrix basis = wide_cleaned(free.null(), WideMatrix::Ones(s_.n, m.n1));
  embedding_ = WideMatrix::Zero(s_.size(), m.ny);
  embedding_.topLeftCorner(s_.n, m.n1) = basis;
  sources_constrain_ = !constraints_.rightCols(s_.n_zeta).isZero(0);
  if (sources_constrain_) embedding_.topRightCorner(s_.n, s_.n_zeta) = -free.least(constraints_.rightCols(s_.n_zeta));
  embedding_.bottomRightCorner(s_.n_zeta, s_.n_zeta).setIdentity();
  m.basis = basis.cast<double>();
  m.lift = embedding_.topRightCorner(s_.n, s_.n_zeta).cast<double>();
}

/// False where its rates are beyond computing.
bool Builder::build_flow() {
  Mode& m = *mode_;
  WideMatrix rate = manifold_ ? manifold_->rate : wide_clean_sum(w_->a.topRows(s_.n), r_.b.topRows(s_.n), kj_);
  if (m.constrained) {
    // c' = Nᵀ(ξ' − R ζ').
    rate = wide_clean_product(rate, embedding_);
    if (sources_constrain_)
      rate.rightCols(s_.n_zeta) =
          wide_clean_sum(rate.rightCols(s_.n_zeta), -embedding_.topRightCorner(s_.n, s_.n_zeta), s_.exosystem->a().cast<Wide>());
    rate = wide_clean_product(embedding_.topLeftCorner(s_.n, m.n1).transpose(), rate);
  }
  Matrix a = Matrix::Zero(m.ny, m.ny);
  a.topRows(m.n1) = rate.cast<double>();
  a.bottomRightCorner(s_.n_zeta, s_.n_zeta) = s_.exosystem->a();
  if (!(linalg::norm_bound(a) < fastest_rate)) return false;
  flow_ = std::move(a);
  return true;
}

/// rows(row, ·) += input·K, cleaned.
template <class Input>
void Builder::add_inputs(WideMatrix& rows, Eigen::Index row, const Input& input, Wide rounding) {
  input_.resize(kj_.rows());
  for (std::size_t a = 0; a < r_.j.size(); ++a) input_[static_cast<Eigen::Index>(a)] = input[r_.j[a]];
  if (input_.isZero(0)) return;
  for (Eigen::Index j = 0; j < rows.cols(); ++j) {
    Wide sum = rows(row, j);
    Wide bound = std::abs(sum);
    for (Eigen::Index a = 0; a < input_.size(); ++a) {
      const Wide term = input_[a] * kj_(a, j);
      sum += term;
      bound += std::abs(term);
    }
    rows(row, j) = std::abs(sum) <= rounding * bound ? 0 : sum;
  }
}

/// Rows that read x as rows that read y.
Matrix Builder::in_mode(const Mode& m, const WideMatrix& full) const {
  return (m.constrained ? wide_clean_product(full, embedding_) : full).cast<double>();
}

/// factor·u or factor·y of a diode port; port −1: neither.
struct PortReading {
  int port = -1;
  double factor = 0.0;
  bool of_input = false;
};

PortReading port_reading(const System& s, const OutputRow& value) {
  if (!value.reads_ports()) return {};
  Eigen::Index lead = 0;
  const double largest = std::max(value.input.cwiseAbs().maxCoeff(&lead), value.state.size() > 0 ? value.state.cwiseAbs().maxCoeff() : 0.0);
  const bool reads_one = (value.input.array() != 0.0).count() == 1 && value.state.isZero(0.0);
  if (reads_one && lead < s.diodes) return {static_cast<int>(lead), value.input[lead], true};
  for (int i = 0; i < s.diodes; ++i) {
    if (s.d(i, lead) == 0.0) continue;
    const double factor = value.input[lead] / s.d(i, lead);
    if ((value.input.transpose() - factor * s.d.row(i)).cwiseAbs().maxCoeff() > tolerance::row_entry * largest) continue;
    if ((value.state.transpose() - factor * s.c.row(i)).cwiseAbs().maxCoeff() <= tolerance::row_entry * largest) return {i, factor, false};
  }
  return {};
}

/// A control that reads the current or the voltage of a diode reads the port's own row, and zero where the port holds it at zero.
void Builder::take_port_rows(const Mode& m, WideMatrix& rows) const {
  for (std::size_t i = 0; i < s_.controls.size(); ++i) {
    const PortReading reading = port_reading(s_, s_.controls[i].value);
    if (reading.port < 0) continue;
    auto row = rows.row(s_.diodes + static_cast<Eigen::Index>(i));
    if (reading.of_input == m.active.contains(reading.port))
      row = static_cast<Wide>(reading.factor) * rows.row(reading.port);
    else
      row.setZero();
  }
}

/// A control that is nothing but rounding of what it reads, the current of a diode that blocks, say: in proportion to the largest row of a port, as a
/// diode's is.
void Builder::clean_control_rows(Matrix& rows) const {
  double largest = kj_.rows() > 0 ? static_cast<double>(kj_.rowwise().norm().maxCoeff()) : 0.0;
  if (s_.diodes > 0) largest = std::max(largest, rows.topRows(s_.diodes).rowwise().norm().maxCoeff());
  for (std::size_t i = 0; i < s_.controls.size(); ++i) {
    const OutputRow& value = s_.controls[i].value;
    if (!value.reads_ports()) continue;
    auto row = rows.row(s_.diodes + static_cast<Eigen::Index>(i));
    const double size = value.state.norm() + value.input.cwiseAbs().maxCoeff() * largest;
    if (row.norm() <= static_cast<double>(tolerance::output_rounding) * size) row.setZero();
  }
}

/// Of diodes, controls and outputs in y.
Matrix Builder::mode_rows(const Mode& m) {
  const auto controls = static_cast<int>(s_.controls.size());
  const auto outputs = static_cast<int>(s_.outputs.size());
  WideMatrix full(s_.diodes + controls + outputs, s_.size());
  for (std::size_t a = 0; a < r_.j.size() && r_.j[a] < s_.diodes; ++a) full.row(r_.j[a]) = kj_.row(static_cast<Eigen::Index>(a));
  for (int i = 0; i < s_.diodes; ++i) {
    if (m.active.contains(i)) continue;
    full.row(i) = w_->c.row(i);
    add_inputs(full, i, w_->d.row(i), manifold_ ? tolerance::manifold_rounding : linalg::wide_clean_tolerance);
  }
  for (int i = 0; i < controls + outputs; ++i) {
    const OutputRow& row =
        i < controls ? s_.controls[static_cast<std::size_t>(i)].value : s_.outputs[static_cast<std::size_t>(i - controls)];
    full.row(s_.diodes + i) = row.state.transpose().cast<Wide>();
    add_inputs(full, s_.diodes + i, row.input, tolerance::output_rounding);
  }
  take_port_rows(m, full);
  for (const int port : blocked_ports(s_, m.active)) full.row(port).setZero();
  Matrix rows = in_mode(m, full);
  clean_control_rows(rows);
  return rows;
}

Matrix Builder::guards_of(const Mode& m, const Matrix& rows) const {
  const auto controls = static_cast<int>(s_.controls.size());
  Matrix guards(s_.diodes + 2 * controls, m.ny);
  guards.topRows(s_.diodes) = rows.topRows(s_.diodes);
  for (int i = 0; i < controls; ++i) {
    const Control& control = s_.controls[static_cast<std::size_t>(i)];
    const int constant = s_.exosystem->constant();
    const int on_row = s_.diodes + 2 * i;
    guards.row(on_row) = rows.row(s_.diodes + i);
    guards.row(on_row + 1) = -rows.row(s_.diodes + i);
    if (constant >= 0) {
      guards(on_row, m.n1 + constant) -= control.off_level;
      guards(on_row + 1, m.n1 + constant) += control.on_level;
    }
  }
  return guards;
}

/// As rows of x; nothing where there is none.
std::optional<Matrix> Builder::guards_at_other_shift(const Mode& m, ShiftedSystems& shifted) {
  std::optional<Feedback> other = feedback_at_other_shift(s_, r_.j, shifted, *manifold_);
  if (!other) return std::nullopt;
  kj_ = std::move(other->inputs);
  if (other->free_inputs.cols() > 0) share_by_least_norm(other->free_inputs);
  const WideMatrix& slow = other->slow;
  embedding_.topLeftCorner(s_.n, m.n1) = slow;
  embedding_.topRightCorner(s_.n, s_.n_zeta) = other->lift - product(slow, product(slow.transpose(), other->lift));
  const Matrix guards = guards_of(m, mode_rows(m));
  Matrix rows(guards.rows(), s_.size());
  rows << guards.leftCols(m.n1) * slow.cast<double>().transpose(), guards.rightCols(s_.n_zeta);
  return rows;
}

void Builder::build_rows() {
  Mode& m = *mode_;
  const Matrix rows = mode_rows(m);
  m.guards = guards_of(m, rows);
  m.outputs = rows.bottomRows(static_cast<Eigen::Index>(s_.outputs.size()));
  finish_mode(s_, m, std::move(flow_));
  if (kj_error_.size() > 0) bound_guard_noise();
}

/// Each diode's guard has the digits of its own row: the small current of a port beside large ones has fewer than they have, and a large one does not
/// lose any to them.
void Builder::bound_guard_noise() const {
  Mode& m = *mode_;
  const WideVector of_input = kj_error_.rowwise().norm();
  std::size_t a = 0;
  for (int i = 0; i < s_.diodes; ++i) {
    const bool is_active = m.active.contains(i);
    Wide error = is_active ? of_input[static_cast<Eigen::Index>(a++)] : 0;
    for (std::size_t j = 0; !is_active && j < r_.j.size(); ++j)
      error += std::abs(w_->d(i, r_.j[j])) * of_input[static_cast<Eigen::Index>(j)];
    if (m.guard_norm[i] > 0.0)
      m.guard_noise[i] =
          std::clamp(static_cast<double>(error) / m.guard_norm[i], tolerance::noise_floor, std::max(m.noise, tolerance::largest_row_noise));
  }
}

/// What the decays beside the slow motion add to the guards: in the mode itself they are states like others.
void Builder::add_decays(const Mode& whole, Mode& slow) const {
  auto decays = std::make_unique<Decays>();
  decays->time_constants = manifold_->time_constants;
  decays->slowest = manifold_->slowest;
  decays->rate_doubt = manifold_->rate_doubt;
  decays->coordinates = manifold_->coordinates;
  const Matrix fast =
      whole.constrained ? Matrix(whole.basis.transpose() * (whole.projector.topLeftCorner(s_.n, s_.n) * manifold_->fast)) : manifold_->fast;
  decays->guards = whole.guards.leftCols(whole.n1) * fast;
  decays->guard_doubt = static_cast<double>(tolerance::output_rounding) * (whole.absolute_guards.leftCols(whole.n1) * fast.cwiseAbs());
  decays->guard_rounding = whole.guard_noise.cwiseProduct(whole.guard_norm);
  slow.decays = std::move(decays);
}

}  // namespace

Mode::Mode() = default;
Mode::~Mode() = default;

std::unique_ptr<Mode> build_mode(const System& system, const IndexSet& active) {
  IndexSet held = active;
  hold_blocked(system, held);
  return Builder(system, held).run();
}

std::unique_ptr<Mode> build_slow_mode(const System& system, const Mode& whole, const Rates& rates, ShiftedSystems& shifted,
                                      double longest) {
  if (!whole.regular || whole.ny == 0 || !has_fast_decays(system, rates, longest)) return nullptr;
  return Builder(system, whole.active).run_slow(whole, rates, shifted, longest);
}

}  // namespace pwlsim::model
