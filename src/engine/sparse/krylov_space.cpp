#include "engine/sparse/krylov_space.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/arithmetic.hpp"
#include "base/disjoint_sets.hpp"
#include "engine/sparse/tolerances.hpp"
#include "linalg/columns.hpp"
#include "linalg/factorisations.hpp"
#include "linalg/hessenberg_eigenvalues.hpp"
#include "linalg/small.hpp"

namespace pwlsim::engine::sparse {

namespace {

using linalg::Matrix;
using linalg::Vector;

constexpr double share_of_input = 1e-6;  ///< of the largest current: less is rounding, or a leak
constexpr double clear_direction = 1e3;  ///< of the rounding of T z: what is left of it has three digits
constexpr double share_of_integral = 0.1;
constexpr double most_growth = 1e3;  ///< of y over a segment, sources included: more is made of rounding
/// Of what the motion begins with: terms, and what each is at most of the one before, but for the first, in which motions may cancel. What shrinks no further is rounding.
constexpr int most_terms = 40, first_terms = 2;
constexpr double share_of_term = 0.25;
constexpr double least_current = 1e-6;  ///< of the voltages, both in volts: where all begin at zero, a current is no part of itself

/// The rows of G that are rows of E, too, as columns.
linalg::SparseMatrix conduction_of_stores(const linalg::SparseMatrix& conduction, const std::vector<char>& is_differential) {
  std::vector<double> values = conduction.values;
  for (std::size_t e = 0; e < values.size(); ++e)
    if (is_differential[static_cast<std::size_t>(conduction.pattern.row[e])] == 0) values[e] = 0.0;
  return linalg::transposed(linalg::without_zeros(conduction.pattern, values), conduction.pattern.size);
}

}  // namespace

KrylovSpace::KrylovSpace(const Descriptor& descriptor, const model::Exosystem& exosystem, double stop)
    : descriptor_(descriptor),
      exosystem_(exosystem),
      change_(descriptor, exosystem),
      resting_(descriptor),
      differential_(descriptor.differential_rows()),
      stores_(descriptor.memory_diagonal()),
      coupling_(coupling_of(descriptor.network())),
      conduction_of_stores_(conduction_of_stores(descriptor.conduction(), differential_)),
      conduction_of_nodes_(linalg::transposed(descriptor.conduction(), descriptor.nodes())) {
  for (double& value : conduction_of_nodes_.values) value = std::abs(value);
  source_weight_ = Vector::Ones(exosystem.size());
  // A milliampere counts as much as the constant 1; a kilovolt keeps counting as more.
  std::vector<double> zeta(static_cast<std::size_t>(exosystem.size()));
  exosystem.evaluate(exosystem.start(), 0.0, zeta.data());
  for (const auto& block : exosystem.blocks()) {
    const bool is_ramp = block.kind == model::Exosystem::Block::Kind::ramp;
    const double most = is_ramp ? std::abs(zeta[static_cast<std::size_t>(block.first)]) + block.rate * stop : block.scale;
    source_weight_[block.first] = std::max(1.0, 1.0 / std::min(block.scale, most));
  }
  const double r0 = descriptor.r0();
  for (const State& state : descriptor.states()) {
    state_weight_.push_back(std::sqrt(std::abs(state.storage) * (state.is_current ? 1.0 / r0 : r0)));
    double& sum = state.is_current ? weight_of_currents_ : weight_of_voltages_;
    sum = std::hypot(sum, state_weight_.back());
    if (state.is_current && state.storage != 0.0) weight_of_rates_ = std::hypot(weight_of_rates_, std::sqrt(r0 / std::abs(state.storage)));
  }
}

/// Σ L_i i_i² is at least a part of the energy of inductors that are coupled, one of their number: |M_ij| <= √(L_i L_j).
double KrylovSpace::coupling_of(const model::Network& network) {
  DisjointSets sets(static_cast<int>(network.inductors.size()));
  for (const model::Coupling& k : network.couplings) sets.join(k.inductor_a, k.inductor_b);
  std::vector<double> count(network.inductors.size(), 0.0);
  double most = 1.0;
  for (int i = 0; i < static_cast<int>(count.size()); ++i) most = std::max(most, ++count[static_cast<std::size_t>(sets.find(i))]);
  return std::sqrt(most);
}

double KrylovSpace::energy_distance(const std::vector<double>& a, const std::vector<double>& b) const {
  double square = 0.0;
  for (std::size_t i = 0; i < state_weight_.size(); ++i) {
    const State& state = descriptor_.states()[i];
    if (!state.is_current) square += std::pow(state_weight_[i] * (state.value(a.data()) - state.value(b.data())), 2);
  }
  const auto first = static_cast<std::size_t>(descriptor_.unknowns().inductor(0));
  for (std::size_t i = first; i < first + descriptor_.network().inductors.size(); ++i) square += stores_[i] * std::pow(a[i] - b[i], 2);
  return std::sqrt(square);
}

/// Room for so many columns.
void KrylovSpace::reserve(int columns) {
  if (vectors_.cols() >= columns) return;
  const auto n = static_cast<Eigen::Index>(descriptor_.size()), zetas = static_cast<Eigen::Index>(exosystem_.size());
  const Eigen::Index cols = std::max<Eigen::Index>(columns, 2 * vectors_.cols());
  vectors_.conservativeResize(n, cols);
  changes_.conservativeResize(n, cols);
  sums_.conservativeResize(n, cols);
  lost_.conservativeResize(cols);
  delta_.conservativeResize(cols);
  largest_.conservativeResize(4, cols);
  passed_on_.conservativeResizeLike(Matrix::Zero(cols, cols));
  zetas_.conservativeResize(zetas, cols);
  zeta_changes_.conservativeResize(zetas, cols);
  measured_.conservativeResize(static_cast<Eigen::Index>(state_weight_.size()) + zetas, cols);
}

KrylovSpace::Begun KrylovSpace::begin(const Factor& factor, double shift, const Position& on, const Origin& start, double size) {
  factor_ = &factor;
  shift_ = shift;
  on_ = on;
  dimension_ = 0;
  full_ = may_go_on_ = false;
  sound_ = true;
  is_assembled_ = false;
  h_matrix_.resize(1, 0);
  const Vector before = Eigen::Map<const Vector>(start.zeta.data(), static_cast<Eigen::Index>(start.zeta.size()));
  const Vector zeta = after_step(exosystem_, 1.0 / shift, before);
  resting_.find(on, {start.z, start.more, !before.isZero(0.0)}, state_weight_, size);
  given_start_ = start_ = start.z;
  resting_.cut_off(start_);
  forget_inputs();
  begin_change({start_, start.more, start.zeta}, before);
  given_ = right_;
  factor.solve(right_);
  refine(right_, tolerance::refined_solution * size);
  rounding_ = is_refined_ ? rounding_of(right_, tolerance::first_solution * size) : 0.0;
  for (std::size_t i = 0; i < right_.size(); ++i) right_[i] += start_[i];
  rounding_ = std::hypot(rounding_, rounding_of_sums(right_));
  const Vector w = exosystem_.values(zeta);
  const double one = zeta[exosystem_.constant()];
  settle(right_, w, one);
  resting_.hold(right_);
  if (contradicts(right_, w, one)) return Begun::contradicted;
  reserve(1);
  Vector x(measured_.rows());
  zeta_weight_ = 0.0;
  measure(right_, zeta, x.data());
  size_ = x.norm();
  largest_size_ = std::max(size, size_);
  zeta_weight_ = largest_size_ / source_weight_.cwiseProduct(zeta).norm();
  if (!(zeta_weight_ > 0.0) || zeta.isZero(0.0)) zeta_weight_ = 1.0;
  measure(right_, zeta, x.data());
  norm_ = x.norm();
  passed_on_.row(0).setZero();
  lost_[0] = passed_on_(0, 0) = 1.0;
  vectors_.col(0) = Eigen::Map<const Vector>(right_.data(), vectors_.rows()) / norm_;
  zetas_.col(0) = zeta / norm_;
  measured_.col(0) = x / norm_;
  return Begun::yes;
}

/// What flowed through ports that are off now is no part of S z0, and would leave its rounding in rows of leaks.
void KrylovSpace::forget_inputs() {
  const auto nodes = static_cast<std::size_t>(descriptor_.nodes());
  const double current = largest(std::span(start_).subspan(nodes));
  double most = 0.0;
  for (std::size_t i = 0; i < on_.size(); ++i)
    if (on_[i] == 0) most = std::max(most, std::abs(start_[static_cast<std::size_t>(descriptor_.ports()[i].row)]));
  if (!(most > share_of_input * current)) return;
  for (std::size_t i = 0; i < on_.size(); ++i)
    if (on_[i] == 0) start_[static_cast<std::size_t>(descriptor_.ports()[i].row)] = 0.0;
}

std::vector<double> KrylovSpace::first_unknowns() const {
  std::vector<double> z(static_cast<std::size_t>(descriptor_.size()));
  Eigen::Map<Vector>(z.data(), vectors_.rows()) = norm_ * vectors_.col(0);
  return z;
}

std::vector<double> KrylovSpace::next_unknowns() const {
  std::vector<double> z(static_cast<std::size_t>(descriptor_.size()), 0.0);
  if (has_next_) Eigen::Map<Vector>(z.data(), vectors_.rows()) = vectors_.col(dimension_);
  return z;
}

/// By way of S² z₀, as what S z₀ has of impulses, and of the rounding of such, is in no point of the motion.
std::optional<KrylovSpace::Beginning> KrylovSpace::unknowns_at_start() {
  apply(0);
  vectors_.col(0) += changes_.col(0);
  zetas_.col(0) += zeta_changes_.col(0);
  Vector sum = vectors_.col(0);
  const Eigen::Index nodes = descriptor_.nodes(), others = sum.size() - nodes;
  const auto largest_of = [](const auto& part) { return part.size() > 0 ? part.cwiseAbs().maxCoeff() : 0.0; };
  const auto share_of = [](double part, double whole) { return part > 0.0 ? part / whole : 0.0; };
  double before = INFINITY;
  Beginning beginning;
  for (int k = 1; k <= most_terms; ++k) {
    apply(0);
    note_decay(beginning.decays);
    vectors_.col(0) = -changes_.col(0);
    zetas_.col(0) = -zeta_changes_.col(0);
    const Vector& term = vectors_.col(0);
    const double voltage = largest_of(sum.head(nodes)), current = std::max(largest_of(sum.tail(others)), least_current * voltage);
    const double size = std::max(share_of(largest_of(term.head(nodes)), voltage), share_of(largest_of(term.tail(others)), current));
    const bool shrinks = k <= first_terms || size <= share_of_term * before;
    if (!shrinks && !(before <= tolerance::unknown_rounding)) return std::nullopt;
    if (shrinks) sum += (k + 1.0) * term;
    if (!shrinks || size <= tolerance::solution_rounding) {
      beginning.z.resize(static_cast<std::size_t>(descriptor_.size()));
      Eigen::Map<Vector>(beginning.z.data(), vectors_.rows()) = norm_ * sum;
      return beginning;
    }
    before = size;
  }
  return std::nullopt;
}

/// T of the last vector.
void KrylovSpace::note_decay(std::vector<std::vector<double>>& decays) const {
  std::vector<double> decay(changes_.col(0).begin(), changes_.col(0).end());
  const double energy = energy_distance(decay, std::vector<double>(decay.size(), 0.0));
  if (!(energy > 0.0)) return;
  for (double& value : decay) value /= energy;
  decays.push_back(std::move(decay));
}

std::vector<double> KrylovSpace::impulses() {
  const Vector c = norm_ * k_.col(0);  // (1 − γ A_m)⁻¹ = 1 + H takes y(0) to norm·e₁
  std::vector<double> z(static_cast<std::size_t>(descriptor_.size()));
  Eigen::Map<Vector>(z.data(), vectors_.rows()) = norm_ * vectors_.col(0) - sums_.leftCols(dimension_) * c;
  resting_.add_impulses(given_start_, stores_, shift_, z);
  return z;
}

/// T z of the last vector, in right_ and changes_.
void KrylovSpace::apply(int j) {
  const Vector zeta = zetas_.col(j);
  const Vector change = after_step(exosystem_, 1.0 / shift_, exosystem_.rates(zeta) / shift_);
  right_.resize(static_cast<std::size_t>(descriptor_.size()));
  linalg::multiply_transposed(conduction_of_stores_, vectors_.col(j).data(), right_.data());
  for (double& value : right_) value = -value;
  add_sources(zeta, right_);
  for (std::size_t i = 0; i < right_.size(); ++i)
    if (differential_[i] == 0) right_[i] = 0.0;
  const Vector w = exosystem_.values(change);
  descriptor_.add_sources(w.data(), right_.data());
  solve(right_, w, change[exosystem_.constant()]);
  changes_.col(j) = Eigen::Map<const Vector>(right_.data(), changes_.rows());
  sums_.col(j) = vectors_.col(j) + changes_.col(j);
  note_largest(vectors_, 0, j);
  note_largest(changes_, 2, j);
  zeta_changes_.col(j) = change;
}

void KrylovSpace::add_vector() {
  const int j = dimension_;
  reserve(j + 2);
  apply(j);
  Vector x(measured_.rows());
  measure(right_, zeta_changes_.col(j), x.data());
  const double size = x.norm();
  const double h = linalg::append_to_hessenberg(measured_.leftCols(j + 1), x, h_matrix_);
  const Vector c = h_matrix_.col(j).head(j + 1);
  dimension_ = j + 1;
  const double nothing = std::max(tolerance::new_direction * size, tolerance::least_direction);
  const bool adds_nothing = !(h > nothing);
  delta_[j] = rounding_of(right_, adds_nothing ? tolerance::little_direction : std::min(h, tolerance::little_direction));
  full_ = adds_nothing || !(h > delta_[j]);
  has_next_ = !full_;
  may_go_on_ = full_ && h > std::max(tolerance::least_direction, clear_direction * delta_[j]);
  if (full_ && !may_go_on_) return;
  note_lost(c, size, h);
  const Vector less = -c;
  vectors_.col(j + 1) = changes_.col(j);
  linalg::add_product(linalg::first_columns(vectors_, j + 1), less.data(), vectors_.col(j + 1).data());
  vectors_.col(j + 1) /= h;
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

bool KrylovSpace::goes_on() {
  if (!std::exchange(may_go_on_, false)) return false;
  full_ = false;
  has_next_ = true;
  return true;
}

void KrylovSpace::grow(int m) {
  const int before = dimension_;
  while (dimension_ < m && !full_) add_vector();
  if (dimension_ > before) reduce();
}

void KrylovSpace::shrink(int m) {
  has_next_ |= m < dimension_;
  may_go_on_ = false;
  dimension_ = m;
  full_ = true;
  reduce();
}

void KrylovSpace::reduce() {
  rates_of_motions_.reset();
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

KrylovSpace::Relation KrylovSpace::relation() const {
  Matrix h = h_matrix_.topLeftCorner(dimension_ + 1, dimension_);
  Vector delta = delta_.head(dimension_) + tolerance::solution_rounding * h.colwise().norm().transpose();  // orthogonalisation rounds, too
  if (!has_next_) delta[dimension_ - 1] += h_;
  return {std::move(h), k_, zetas_.leftCols(dimension_ + (has_next_ ? 1 : 0)), std::move(delta), flow_, first_, shift_, has_next_};
}

double KrylovSpace::turning(double least) const {
  const Matrix& a = flow_.a();
  const double bound = 0.5 * (a - a.transpose()).norm();  // Bendixson
  if (!(bound > least)) return bound;
  double fastest = 0.0;
  for (const std::complex<double>& rate : rates_of_motions()) fastest = std::max(fastest, std::abs(rate.imag()));
  return fastest;
}

/// A_m = H (1 + H)⁻¹/γ has the eigenvectors of H.
const linalg::Rates& KrylovSpace::rates_of_motions() const {
  if (rates_of_motions_) return *rates_of_motions_;
  linalg::Rates& rates = rates_of_motions_.emplace(linalg::hessenberg_eigenvalues(h_matrix_.topLeftCorner(dimension_, dimension_)));
  for (std::complex<double>& rate : rates) rate *= shift_ / (1.0 + rate);
  std::sort(rates.begin(), rates.end(), [](const auto& x, const auto& y) { return std::abs(x) > std::abs(y); });
  return rates;
}

double KrylovSpace::defect_at_start() const { return h_ * std::abs(last_row_.dot(flow_.a() * first_) - shift_ * last_row_.dot(first_)); }

/// Of the error, which is along z_{m+1}, where that is a larger part of some state's size than of the largest √energy: how many times. Where the space is full there is no such vector.
double KrylovSpace::weight_of_error() const {
  double weight = 1.0;
  if (!has_next_) return weight;
  for (std::size_t i = 0; i < state_sizes_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double start = norm_ * std::abs(measured_(row, 0)), most = std::max(state_weight_[i] * state_sizes_[i], start);
    if (most > 0.0 && descriptor_.states()[i].flux.empty())
      weight = std::max(weight, std::abs(measured_(row, dimension_)) / most * largest_size_);
  }
  return std::min(weight, tolerance::most_weight_of_error);
}

/// Of checkpoints over a length: a power of two, for which the flow keeps its matrix.
double KrylovSpace::step_of(double length) { return std::exp2(std::ceil(std::log2(length / checkpoints))); }

const std::vector<KrylovSpace::Checkpoint>& KrylovSpace::estimate(double length) {
  const int m = dimension_;
  estimate_.clear();
  const double weight = weight_of_error() * h_;
  const double step = step_of(length);
  Vector y = first_;
  work_.resize(2 * m);
  reach_ = first_.cwiseAbs();
  const Vector d = flow_.a().transpose() * last_row_ - shift_ * last_row_;
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
    const double error = weight * (std::abs(last_row_.dot(y)) + share_of_integral * integral);
    estimate_.push_back({reached, y.norm() <= most_growth * norm_ && std::isfinite(error) ? error : INFINITY, rounding});
  }
  return estimate_;
}

bool KrylovSpace::grows(double length) {
  Vector y(dimension_);
  for (Eigen::Index i = 0; i < y.size(); ++i) y[i] = i % 2 == 0 ? 1.0 : -1.0;
  const double before = y.norm();
  work_.resize(2 * static_cast<std::size_t>(dimension_));
  const double step = dimension_ > linalg::largest_small ? step_of(length) : length;  // small matrices are squared faster than that
  for (double left = length; left > 0.0; left -= step) flow_.apply_once(std::min(step, left), y.data(), work_.data());
  return !(y.norm() <= most_growth * before);
}

/// All of a vector at once: forms read it in any order.
Matrix KrylovSpace::rows(const std::vector<Reading>& readings) const {
  Matrix of_vectors(static_cast<Eigen::Index>(readings.size()), dimension_);
  Vector zeta, w;
  for (Eigen::Index j = 0; j < dimension_; ++j) {
    const double* const z = sums_.col(j).data();
    zeta = zetas_.col(j) + zeta_changes_.col(j);
    w = exosystem_.values(zeta);
    const double one = zeta[exosystem_.constant()];
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const Reading& value = readings[i];
      const double size = value.form != nullptr ? Form::sum(value.form->z, z, source_part(*value.form, w, one))
                          : value.unknown >= 0  ? z[value.unknown]
                                                : 0.0;
      of_vectors(static_cast<Eigen::Index>(i), j) = value.factor * size + value.offset * one;
    }
  }
  return of_vectors * k_;
}

Vector KrylovSpace::row_of_unknowns(const Form& form) const {
  Vector sum = Vector::Zero(dimension_);
  for (const Form::IndexedTerm& part : form.z) sum += part.coefficient * sums_.row(part.index).head(dimension_).transpose();
  return k_.transpose() * sum;
}

double KrylovSpace::row_terms(const Form& form) const {
  Vector sum = Vector::Zero(dimension_);
  for (const Form::IndexedTerm& part : form.z)
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
  z.assign(static_cast<std::size_t>(descriptor_.size()), 0.0);
  linalg::add_product(linalg::first_columns(sums_, dimension_), c.data(), z.data());
}

double KrylovSpace::rounding_at_start() {
  const Vector c = (k_ * first_).cwiseAbs();
  sizes_.resize(static_cast<std::size_t>(descriptor_.size()));
  Eigen::Map<Vector>(sizes_.data(), vectors_.rows()) =
      vectors_.leftCols(dimension_).cwiseAbs() * c + changes_.leftCols(dimension_).cwiseAbs() * c;
  return rounding_of_sums(sizes_);
}

void KrylovSpace::rates(const double* y, std::vector<double>& k, std::vector<double>& sizes) {
  const Vector slope = flow_.a() * Eigen::Map<const Vector>(y, dimension_);
  unknowns(slope.data(), right_);
  k.resize(right_.size());
  sizes.resize(right_.size());
  descriptor_.memory(right_.data(), k.data());
  descriptor_.memory_sizes(right_.data(), sizes.data());
}

}  // namespace pwlsim::engine::sparse
