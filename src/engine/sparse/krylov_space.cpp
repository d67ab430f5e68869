#include "engine/sparse/krylov_space.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/largest.hpp"
#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

using linalg::Matrix;
using linalg::Vector;

constexpr double residual_factor = 4.0;  ///< of what a solution's residual makes of the states, their rounding
constexpr int corrections = 3, most_refinements = 8;
constexpr double share_of_integral = 0.1, share_of_start = 1e-3;
constexpr double most_growth = 1e3;  ///< of y over a segment: more is made of rounding

}  // namespace

KrylovSpace::KrylovSpace(const Descriptor& descriptor, const model::Exosystem& exosystem)
    : descriptor_(descriptor), exosystem_(exosystem), change_(descriptor, exosystem), differential_(descriptor.differential_rows()) {
  const double r0 = descriptor.r0();
  for (const State& state : descriptor.states()) {
    state_weight_.push_back(std::sqrt(std::abs(state.storage) * (state.is_current ? 1.0 / r0 : r0)));
    double& sum = state.is_current ? weight_of_currents_ : weight_of_voltages_;
    sum = std::hypot(sum, state_weight_.back());
    if (state.is_current && state.storage != 0.0) weight_of_rates_ = std::hypot(weight_of_rates_, std::sqrt(r0 / std::abs(state.storage)));
  }
}

double KrylovSpace::source_part(const Form& form, const Vector& w, double one) const {
  return Form::sum(form.w, w.data(), form.constant * one);
}

/// r −= H C ζ + g ζ₁
void KrylovSpace::add_sources(const Vector& zeta, std::vector<double>& r) const {
  const Vector w = exosystem_.rows() * zeta;
  descriptor_.add_sources(w.data(), r.data());
  descriptor_.add_constants(zeta[exosystem_.constant()], r.data());
}

/// Closing rows of a right-hand side.
void KrylovSpace::close(const Vector& zeta, std::vector<double>& r) const {
  const Vector w = exosystem_.rows() * zeta;
  const double one = zeta[exosystem_.constant()];
  for (std::size_t i = 0; i < on_.size(); ++i) {
    const Port& port = descriptor_.ports()[i];
    const double given = source_part(port.slack, w, one);
    const double weight = factor_->closing() ? factor_->closing()->of_slack[i] : on_[i] != 0 ? 1.0 : 0.0;
    r[static_cast<std::size_t>(port.row)] = -weight * given;
  }
}

/// r := the unknowns; ζ goes with them.
void KrylovSpace::solve(std::vector<double>& r, const Vector& zeta) {
  close(zeta, r);
  given_ = r;
  factor_->solve(r);
  settle(r, zeta);
}

/// What the factor leaves open or only nearly holds in a solution.
void KrylovSpace::settle(std::vector<double>& z, const Vector& zeta) {
  const Vector w = exosystem_.rows() * zeta;
  const double one = zeta[exosystem_.constant()];
  if (factor_->closing()) return correct(z, w, one);
  if (!factor_->ties().empty()) return share_out(z, w, one);
  for (std::size_t i = 0; i < on_.size(); ++i)
    if (on_[i] == 0) z[static_cast<std::size_t>(descriptor_.ports()[i].row)] = 0.0;
}

/// Right-hand side of S z − z at the start, in right_.
void KrylovSpace::begin_change(const Start& start, const Vector& zeta) {
  change_.take(start.z, start.more, zeta, shift_);
  right_ = change_.right();
  const Descriptor::Closing* closing = factor_->closing() ? &*factor_->closing() : nullptr;
  for (std::size_t i = 0; i < on_.size(); ++i) {
    const double of_slack = closing ? closing->of_slack[i] : on_[i] != 0 ? 1.0 : 0.0;
    const double of_input = closing ? closing->of_input[i] : on_[i] != 0 ? 0.0 : 1.0;
    const Port& port = descriptor_.ports()[i];
    right_[static_cast<std::size_t>(port.row)] = change_.closing(port, of_slack, of_input);
  }
}

/// Takes the factor's ε out again.
void KrylovSpace::correct(std::vector<double>& z, const Vector& w, double one) {
  for (int round = 0; round < corrections; ++round) {
    product_.assign(z.size(), 0.0);
    for (std::size_t i = 0; i < on_.size(); ++i) {
      const Port& port = descriptor_.ports()[i];
      const auto row = static_cast<std::size_t>(port.row);
      product_[row] = on_[i] != 0 ? -(Form::sum(port.slack.z, z.data()) + source_part(port.slack, w, one)) : -z[row];
    }
    factor_->solve(product_);
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += product_[i];
  }
}

/// Of what ties settle, the least squares of all free variables.
void KrylovSpace::share_out(std::vector<double>& z, const Vector& w, double one) const {
  const auto& open = factor_->open();
  if (open.empty()) return;
  Vector moments = Vector::Zero(static_cast<Eigen::Index>(open.size()));
  for (std::size_t i = 0; i < on_.size(); ++i) {
    const Port& port = descriptor_.ports()[i];
    const double value = port.response(on_[i] != 0, z.data()) + (on_[i] != 0 ? 0.0 : source_part(port.slack, w, one));
    for (std::size_t j = 0; j < open.size(); ++j)
      moments[static_cast<Eigen::Index>(j)] += value * port.response(on_[i] != 0, open[j].data());
  }
  const Vector shares = factor_->share_out(moments);
  for (std::size_t j = 0; j < open.size(); ++j)
    for (std::size_t i = 0; i < z.size(); ++i) z[i] -= shares[static_cast<Eigen::Index>(j)] * open[j][i];
}

/// Whether what a position holds at zero is not.
bool KrylovSpace::contradicts(const std::vector<double>& z, const Vector& zeta) const {
  if (!factor_->closing() && factor_->ties().empty()) return false;
  const Vector w = exosystem_.rows() * zeta;
  const double size = std::max(least_, largest(z));
  for (std::size_t i = 0; i < on_.size(); ++i) {
    const Port& port = descriptor_.ports()[i];
    const double rest = on_[i] != 0 ? Form::sum(port.slack.z, z.data()) + source_part(port.slack, w, zeta[exosystem_.constant()])
                                    : z[static_cast<std::size_t>(port.row)];
    if (!(std::abs(rest) <= tolerance::held_row * size)) return true;
  }
  return false;
}

void KrylovSpace::measure(const std::vector<double>& z, const Vector& zeta, double* x) const {
  const auto& states = descriptor_.states();
  for (std::size_t i = 0; i < states.size(); ++i) *x++ = state_weight_[i] * states[i].value(z.data());
  for (const double value : zeta) *x++ = zeta_weight_ * value;
}

double KrylovSpace::distance(const std::vector<double>& a, const std::vector<double>& b) const {
  double square = 0.0;
  for (std::size_t i = 0; i < state_weight_.size(); ++i) {
    const State& state = descriptor_.states()[i];
    square += std::pow(state_weight_[i] * (state.value(a.data()) - state.value(b.data())), 2);
  }
  return std::sqrt(square);
}

double KrylovSpace::size_of_states(const std::vector<double>& z) const {
  double square = 0.0;
  for (std::size_t i = 0; i < state_weight_.size(); ++i) square += std::pow(state_weight_[i] * descriptor_.states()[i].value(z.data()), 2);
  return std::sqrt(square);
}

/// Of the norm of a solution: voltages of stores are differences of those of nodes, and currents of inductors may be held by resistors between nodes, or move by the
/// difference of their voltages in 1/shift, all of which may be far larger.
double KrylovSpace::rounding_of_states(const std::vector<double>& z) {
  const auto nodes = static_cast<std::size_t>(descriptor_.nodes());
  const double voltage = largest(std::span(z).first(nodes));
  double rounding = voltage * (weight_of_voltages_ + weight_of_rates_ / shift_);
  if (weight_of_currents_ > 0.0) {
    sizes_.resize(z.size());
    descriptor_.conduct_sizes(z.data(), sizes_.data());
    rounding += largest(std::span(sizes_).first(nodes)) * weight_of_currents_;
  }
  return tolerance::solution_rounding * rounding;
}

/// product_ := what `given_` and a solution d differ by.
void KrylovSpace::find_residual(const std::vector<double>& d) {
  descriptor_.matrix(shift_, descriptor_.closing(shift_, on_, 0.0), 1.0, values_);
  product_.resize(d.size());
  linalg::multiply(descriptor_.pattern(), values_, d.data(), product_.data());
  for (std::size_t i = 0; i < d.size(); ++i) product_[i] = given_[i] - product_[i];
}

/// The same with sums in extended precision; the matrix is in `values_`.
void KrylovSpace::find_wide_residual(const std::vector<double>& d) {
  const linalg::SparsePattern& pattern = descriptor_.pattern();
  wide_.assign(given_.begin(), given_.end());
  for (std::size_t j = 0; j < d.size(); ++j)
    for (auto e = static_cast<std::size_t>(pattern.start[j]); e < static_cast<std::size_t>(pattern.start[j + 1]); ++e)
      wide_[static_cast<std::size_t>(pattern.row[e])] -= static_cast<linalg::Wide>(values_[e]) * d[j];
  product_.resize(d.size());
  std::transform(wide_.begin(), wide_.end(), product_.begin(), [](linalg::Wide value) { return static_cast<double>(value); });
}

/// Corrects a solution by its residual where the currents that charge capacitors leave others no digits: impulses of voltage of a floating part may be that large.
void KrylovSpace::refine(std::vector<double>& d, double counts) {
  if (factor_->closing() || !factor_->ties().empty() || !(weight_of_currents_ > 0.0)) return;
  sizes_.resize(d.size());
  descriptor_.memory_sizes(d.data(), sizes_.data());
  const double charging = shift_ * largest(std::span(sizes_).first(static_cast<std::size_t>(descriptor_.nodes())));
  if (!(tolerance::solution_rounding * charging * weight_of_currents_ > counts)) return;
  descriptor_.matrix(shift_, descriptor_.closing(shift_, on_, 0.0), 1.0, values_);
  double before = INFINITY;
  for (int round = 0; round < most_refinements; ++round) {
    find_wide_residual(d);
    factor_->solve(product_);
    const double size = size_of_states(product_);
    if (!(size < before)) return;
    before = size;
    for (std::size_t i = 0; i < d.size(); ++i) d[i] += product_[i];
    if (!(before > counts)) return;
  }
}

/// The same as `rounding_of_states`, of a solution d of the factor with right-hand side `given_`: where the bound is more than what counts, it is what the residual of d
/// makes of them, which is the rounding of a row's terms at least, as chance may make it zero. The bound may be far too large: an inductor whose current is cut off has
/// impulses of voltage, of which none reaches a capacitor.
double KrylovSpace::rounding_of(const std::vector<double>& d, double counts) {
  const double bound = rounding_of_states(d);
  if (!(bound > counts) || factor_->closing() || !factor_->ties().empty()) return bound;
  find_residual(d);
  sizes_.resize(d.size());
  linalg::multiply_absolute(descriptor_.pattern(), values_, d.data(), sizes_.data());
  for (std::size_t i = 0; i < d.size(); ++i) {
    const double residual = product_[i], sign = residual != 0.0 ? residual : i % 2 == 0 ? 1.0 : -1.0;
    product_[i] = std::copysign(std::max(std::abs(residual), tolerance::term_rounding * sizes_[i]), sign);
  }
  factor_->solve(product_);
  return std::min(bound, residual_factor * size_of_states(product_));
}

/// Of the norm of states that are differences of these unknowns.
double KrylovSpace::rounding_of_sums(const std::vector<double>& z) const {
  double square = 0.0;
  for (std::size_t i = 0; i < state_weight_.size(); ++i) square += std::pow(state_weight_[i] * descriptor_.states()[i].size(z.data()), 2);
  return tolerance::solution_rounding * std::sqrt(square);
}

/// Room for so many columns.
void KrylovSpace::reserve(int columns) {
  if (vectors_.cols() >= columns) return;
  const auto n = static_cast<Eigen::Index>(descriptor_.size()), zetas = static_cast<Eigen::Index>(exosystem_.size());
  const Eigen::Index cols = std::max<Eigen::Index>(columns, 2 * vectors_.cols());
  vectors_.conservativeResize(n, cols);
  changes_.conservativeResize(n, cols);
  lost_.conservativeResize(cols);
  delta_.conservativeResize(cols);
  largest_.conservativeResize(4, cols);
  passed_on_.conservativeResizeLike(Matrix::Zero(cols, cols));
  zetas_.conservativeResize(zetas, cols);
  zeta_changes_.conservativeResize(zetas, cols);
  measured_.conservativeResize(static_cast<Eigen::Index>(state_weight_.size()) + zetas, cols);
}

KrylovSpace::Begun KrylovSpace::begin(const Factor& factor, double shift, const Position& on, const Start& start, double size) {
  factor_ = &factor;
  shift_ = shift;
  on_ = on;
  dimension_ = 0;
  full_ = false;
  sound_ = true;
  h_matrix_.resize(1, 0);
  const Vector before = Eigen::Map<const Vector>(start.zeta.data(), static_cast<Eigen::Index>(start.zeta.size()));
  const Vector zeta = after_step(exosystem_, 1.0 / shift, before);
  begin_change(start, before);
  given_ = right_;
  factor.solve(right_);
  refine(right_, tolerance::refined_solution * size);
  rounding_ = rounding_of(right_, tolerance::first_solution * size);
  for (std::size_t i = 0; i < right_.size(); ++i) right_[i] += start.z[i];
  rounding_ = std::hypot(rounding_, rounding_of_sums(right_));
  settle(right_, zeta);
  if (contradicts(right_, zeta)) return Begun::contradicted;
  reserve(1);
  Vector x(measured_.rows());
  zeta_weight_ = 0.0;
  measure(right_, zeta, x.data());
  size_ = x.norm();
  zeta_weight_ = std::max(size, size_) / zeta.norm();
  if (!(zeta_weight_ > 0.0)) zeta_weight_ = 1.0;
  measure(right_, zeta, x.data());
  norm_ = x.norm();
  passed_on_.row(0).setZero();
  lost_[0] = passed_on_(0, 0) = 1.0;
  vectors_.col(0) = Eigen::Map<const Vector>(right_.data(), vectors_.rows()) / norm_;
  zetas_.col(0) = zeta / norm_;
  measured_.col(0) = x / norm_;
  return Begun::yes;
}

std::vector<double> KrylovSpace::first_unknowns() const {
  std::vector<double> z(static_cast<std::size_t>(descriptor_.size()));
  Eigen::Map<Vector>(z.data(), vectors_.rows()) = norm_ * vectors_.col(0);
  return z;
}

std::vector<double> KrylovSpace::impulses() const {
  const Vector c = norm_ * k_.col(0);  // (1 − γ A_m)⁻¹ = 1 + H takes y(0) to norm·e₁
  std::vector<double> z(static_cast<std::size_t>(descriptor_.size()));
  Eigen::Map<Vector>(z.data(), vectors_.rows()) =
      norm_ * vectors_.col(0) - vectors_.leftCols(dimension_) * c - changes_.leftCols(dimension_) * c;
  return z;
}

void KrylovSpace::add_vector() {
  const int j = dimension_;
  reserve(j + 2);
  const Vector zeta = zetas_.col(j);
  const Vector change = after_step(exosystem_, 1.0 / shift_, exosystem_.a() * zeta / shift_);
  right_.resize(static_cast<std::size_t>(descriptor_.size()));
  descriptor_.conduct(vectors_.col(j).data(), right_.data());
  add_sources(zeta, right_);
  for (std::size_t i = 0; i < right_.size(); ++i)
    if (differential_[i] == 0) right_[i] = 0.0;
  const Vector w = exosystem_.rows() * change;
  descriptor_.add_sources(w.data(), right_.data());
  solve(right_, change);
  changes_.col(j) = Eigen::Map<const Vector>(right_.data(), changes_.rows());
  note_largest(vectors_, 0, j);
  note_largest(changes_, 2, j);
  zeta_changes_.col(j) = change;

  Vector x(measured_.rows()), c = Vector::Zero(j + 1);
  measure(right_, change, x.data());
  const double size = x.norm();
  const auto basis = measured_.leftCols(j + 1);
  for (int sweep = 0; sweep < 2; ++sweep) {
    const Vector u = basis.transpose() * x;
    x.noalias() -= basis * u;
    c += u;
  }
  const double h = x.norm();
  h_matrix_.conservativeResize(j + 2, j + 1);
  h_matrix_.row(j + 1).setZero();
  h_matrix_.col(j).head(j + 1) = c;
  h_matrix_(j + 1, j) = h;
  dimension_ = j + 1;
  const double nothing = std::max(tolerance::new_direction * size, tolerance::least_direction);
  const bool adds_nothing = !(h > nothing);
  delta_[j] = rounding_of(right_, adds_nothing ? tolerance::little_direction : std::min(h, tolerance::little_direction));
  full_ = adds_nothing || !(h > delta_[j]);
  if (full_) return;
  note_lost(c, size, h);
  vectors_.col(j + 1) = (changes_.col(j) - vectors_.leftCols(j + 1) * c) / h;
  zetas_.col(j + 1) = (zeta_changes_.col(j) - zetas_.leftCols(j + 1) * c) / h;
  measured_.col(j + 1) = x / h;
}

/// A vector that breaks algebraic rows by e is not moved there, as T z is solved for with zeros in them. So the rounding of solutions, ε_i = passed_on_(i, i), goes
/// through  h e_{j+1} = ε_j − Σ c_i e_i: with signs, as magnitudes alone would grow like 3^j where the spectrum is that of diffusion.
void KrylovSpace::note_lost(const Vector& c, double size, double h) {
  const auto j = c.size();
  passed_on_.row(j).setZero();
  passed_on_.row(j).head(j) = -(c.transpose() * passed_on_.topLeftCorner(j, j)) / h;
  passed_on_(j, j) = size / h;
  lost_[j] = passed_on_.row(j).head(j + 1).cwiseAbs().sum();
}

void KrylovSpace::grow(int m) {
  const int before = dimension_;
  while (dimension_ < m && !full_) add_vector();
  if (dimension_ > before) reduce();
}

void KrylovSpace::shrink(int m) {
  dimension_ = m;
  full_ = true;
  reduce();
}

void KrylovSpace::reduce() {
  const int m = dimension_;
  const Matrix h = h_matrix_.topLeftCorner(m, m), one = Matrix::Identity(m, m) + h;
  k_ = Eigen::PartialPivLU<Matrix>(one).inverse();
  sound_ = k_.allFinite() && k_.norm() * one.norm() < tolerance::largest_condition;
  if (!sound_) return;
  const Matrix a = shift_ * (h * k_);
  h_ = h_matrix_(m, m - 1);
  last_row_ = k_.row(m - 1);
  first_ = norm_ * k_.col(0);
  reach_ = first_.cwiseAbs();
  flow_ = linalg::Exponential(a, linalg::norm_bound(a));
}

double KrylovSpace::turning(double least) const {
  const Matrix& a = flow_.a();
  const double bound = 0.5 * (a - a.transpose()).norm();  // Bendixson
  return bound > least ? a.eigenvalues().imag().cwiseAbs().maxCoeff() : bound;
}

const std::vector<KrylovSpace::Checkpoint>& KrylovSpace::estimate(double length) {
  const int m = dimension_;
  estimate_.clear();
  const double step = std::exp2(std::ceil(std::log2(length / checkpoints)));  // whose powers the flow keeps
  Vector y = first_;
  work_.resize(2 * m);
  reach_ = first_.cwiseAbs();
  const Vector d = flow_.a().transpose() * last_row_ - shift_ * last_row_;
  const double at_start = share_of_start * std::abs(last_row_.dot(y));
  const Vector delta = shift_ * (k_.cwiseAbs().transpose() * delta_.head(m));
  double integral = 0.0, slope = std::abs(d.dot(y)), reached = 0.0, rounding = 0.0, push = delta.dot(reach_);
  while (reached < length) {
    const double h = std::min(step, length - reached);
    flow_.apply_once(h, y.data(), work_.data());
    reached = h < step ? length : reached + h;
    reach_ = reach_.cwiseMax(y.cwiseAbs());
    const double slope_before = std::exchange(slope, std::abs(d.dot(y)));
    integral += 0.5 * (slope_before + slope) * h;
    const double push_before = std::exchange(push, delta.dot(y.cwiseAbs()));
    rounding += 0.5 * (push_before + push) * h;
    const double error = h_ * std::max(at_start, std::abs(last_row_.dot(y)) + share_of_integral * integral);
    estimate_.push_back({reached, y.norm() <= most_growth * norm_ && std::isfinite(error) ? error : INFINITY, rounding});
  }
  return estimate_;
}

Vector KrylovSpace::row(int unknown) const {
  return k_.transpose() * (vectors_.row(unknown).head(dimension_) + changes_.row(unknown).head(dimension_)).transpose();
}

Vector KrylovSpace::row_of_unknowns(const Form& form) const {
  Vector sum = Vector::Zero(dimension_);
  for (const Form::Part& part : form.z)
    sum += part.coefficient * (vectors_.row(part.index).head(dimension_) + changes_.row(part.index).head(dimension_)).transpose();
  return k_.transpose() * sum;
}

Vector KrylovSpace::row(const Form& form) const {
  Vector of_zeta = Vector::Zero(exosystem_.size());
  for (const Form::Part& part : form.w) of_zeta += part.coefficient * exosystem_.rows().row(part.index).transpose();
  of_zeta[exosystem_.constant()] += form.constant;
  const Vector sum = (zetas_.leftCols(dimension_) + zeta_changes_.leftCols(dimension_)).transpose() * of_zeta;
  return row_of_unknowns(form) + k_.transpose() * sum;
}

double KrylovSpace::row_terms(const Form& form) const {
  Vector sum = Vector::Zero(dimension_);
  for (const Form::Part& part : form.z)
    sum += std::abs(part.coefficient) *
           (vectors_.row(part.index).head(dimension_).cwiseAbs() + changes_.row(part.index).head(dimension_).cwiseAbs()).transpose();
  return sum.dot(k_.cwiseAbs() * reach_);
}

/// Of the largest of unknowns whose columns have these largest entries in Z and T Z.
double KrylovSpace::terms_of(const Vector& of_vectors, const Vector& of_changes) const {
  return (of_vectors.array() * lost_.head(dimension_).array() + of_changes.array()).matrix().dot(k_.cwiseAbs() * reach_);
}

double KrylovSpace::largest_terms(int first, int count) const {
  const auto largest_of = [&](const Matrix& columns) {
    return Vector(columns.block(first, 0, count, dimension_).cwiseAbs().colwise().maxCoeff().transpose());
  };
  return terms_of(largest_of(vectors_), largest_of(changes_));
}

KrylovSpace::Sizes KrylovSpace::largest_terms() const {
  const auto row = [&](Eigen::Index i) { return Vector(largest_.row(i).head(dimension_).transpose()); };
  return {terms_of(row(0), row(2)), terms_of(row(1), row(3))};
}

/// The largest voltage and the largest other unknown of a column.
void KrylovSpace::note_largest(const Matrix& columns, Eigen::Index row, Eigen::Index j) {
  const Eigen::Index nodes = descriptor_.nodes(), others = columns.rows() - nodes;
  largest_(row, j) = nodes > 0 ? columns.col(j).head(nodes).cwiseAbs().maxCoeff() : 0.0;
  largest_(row + 1, j) = others > 0 ? columns.col(j).tail(others).cwiseAbs().maxCoeff() : 0.0;
}

double KrylovSpace::loss() const {
  const Vector shares = k_.cwiseAbs() * reach_;
  const double sum = shares.sum();
  return sum > 0.0 ? shares.dot(lost_.head(dimension_)) / sum : 1.0;
}

void KrylovSpace::unknowns(const double* y, std::vector<double>& z) const {
  const Vector c = k_ * Eigen::Map<const Vector>(y, dimension_);
  z.resize(static_cast<std::size_t>(descriptor_.size()));
  Eigen::Map<Vector>(z.data(), vectors_.rows()) = vectors_.leftCols(dimension_) * c + changes_.leftCols(dimension_) * c;
}

double KrylovSpace::rounding_at_start() {
  const Vector c = (k_ * first_).cwiseAbs();
  sizes_.resize(static_cast<std::size_t>(descriptor_.size()));
  Eigen::Map<Vector>(sizes_.data(), vectors_.rows()) =
      vectors_.leftCols(dimension_).cwiseAbs() * c + changes_.leftCols(dimension_).cwiseAbs() * c;
  return rounding_of_sums(sizes_);
}

void KrylovSpace::rates(const double* y, std::vector<double>& k) {
  const Vector slope = flow_.a() * Eigen::Map<const Vector>(y, dimension_);
  unknowns(slope.data(), right_);
  k.resize(right_.size());
  descriptor_.memory(right_.data(), k.data());
}

}  // namespace pwlsim::engine::sparse
