/// KrylovSpace: solutions of the equations with a factor, and what rounding leaves in their states.
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/arithmetic.hpp"
#include "engine/sparse/krylov_space.hpp"
#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

using linalg::Vector;

constexpr double residual_factor = 4.0;  ///< of what a solution's residual makes of the states, their rounding
constexpr int corrections = 3, most_refinements = 8;

}  // namespace

double KrylovSpace::source_part(const Form& form, const Vector& w, double one) const {
  return Form::sum(form.w, w.data(), form.constant * one);
}

/// r −= H C ζ + g ζ₁
void KrylovSpace::add_sources(const Vector& zeta, std::vector<double>& r) const {
  const Vector w = exosystem_.values(zeta);
  descriptor_.add_sources(w.data(), r.data());
  descriptor_.add_constants(zeta[exosystem_.constant()], r.data());
}

/// Closing rows of a right-hand side.
void KrylovSpace::close(const Vector& w, double one, std::vector<double>& r) const {
  for (std::size_t i = 0; i < on_.size(); ++i) {
    const DescriptorPort& port = descriptor_.ports()[i];
    const double weight = factor_->closing() ? factor_->closing()->of_slack[i] : on_[i] != 0 ? 1.0 : 0.0;
    r[static_cast<std::size_t>(port.row)] = weight != 0.0 ? -weight * source_part(port.slack, w, one) : 0.0;
  }
}

/// r := the unknowns; sources w and ζ₁ go with them.
void KrylovSpace::solve(std::vector<double>& r, const Vector& w, double one) {
  close(w, one, r);
  given_ = r;
  factor_->solve(r);
  if (refines_ && factor_->is_as_it_stands()) {
    find_residual(r);
    factor_->solve(product_);
    for (std::size_t i = 0; i < r.size(); ++i) r[i] += product_[i];
  }
  settle(r, w, one);
  resting_.hold(r);
}

/// What the factor leaves open or only nearly holds in a solution.
void KrylovSpace::settle(std::vector<double>& z, const Vector& w, double one) {
  if (factor_->closing()) return correct(z, w, one);
  if (!factor_->ties().empty()) return share_out(z, w, one);
  for (std::size_t i = 0; i < on_.size(); ++i)
    if (on_[i] == 0) z[static_cast<std::size_t>(descriptor_.ports()[i].row)] = 0.0;
}

/// Right-hand side of S z − z at the start, in right_.
void KrylovSpace::begin_change(const Origin& start, const Vector& zeta) {
  change_.take(start.z, start.more, zeta, shift_);
  right_ = change_.right();
  const Descriptor::Closing* closing = factor_->closing() ? &*factor_->closing() : nullptr;
  for (std::size_t i = 0; i < on_.size(); ++i) {
    const double of_slack = closing ? closing->of_slack[i] : on_[i] != 0 ? 1.0 : 0.0;
    const double of_input = closing ? closing->of_input[i] : on_[i] != 0 ? 0.0 : 1.0;
    const DescriptorPort& port = descriptor_.ports()[i];
    right_[static_cast<std::size_t>(port.row)] = change_.closing(port, of_slack, of_input, static_cast<int>(i) == start.passed);
  }
}

/// Takes the factor's ε out again.
void KrylovSpace::correct(std::vector<double>& z, const Vector& w, double one) {
  for (int round = 0; round < corrections; ++round) {
    product_.assign(z.size(), 0.0);
    for (std::size_t i = 0; i < on_.size(); ++i) {
      const DescriptorPort& port = descriptor_.ports()[i];
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
    const DescriptorPort& port = descriptor_.ports()[i];
    const double value = port.response(on_[i] != 0, z.data()) + (on_[i] != 0 ? 0.0 : source_part(port.slack, w, one));
    for (std::size_t j = 0; j < open.size(); ++j)
      moments[static_cast<Eigen::Index>(j)] += value * port.response(on_[i] != 0, open[j].data());
  }
  const Vector shares = factor_->share_out(moments);
  for (std::size_t j = 0; j < open.size(); ++j)
    for (std::size_t i = 0; i < z.size(); ++i) z[i] -= shares[static_cast<Eigen::Index>(j)] * open[j][i];
}

/// Whether what a position holds at zero is not.
bool KrylovSpace::contradicts(const std::vector<double>& z, const Vector& w, double one) const {
  if (factor_->is_as_it_stands()) return false;
  const double size = std::max(least_, largest(z));
  for (std::size_t i = 0; i < on_.size(); ++i) {
    const DescriptorPort& port = descriptor_.ports()[i];
    const double rest =
        on_[i] != 0 ? Form::sum(port.slack.z, z.data()) + source_part(port.slack, w, one) : z[static_cast<std::size_t>(port.row)];
    if (!(std::abs(rest) <= tolerance::held_row * size)) return true;
  }
  return false;
}

void KrylovSpace::measure(const std::vector<double>& z, const Vector& zeta, double* x) const {
  const auto& states = descriptor_.states();
  for (std::size_t i = 0; i < states.size(); ++i) *x++ = state_weight_[i] * states[i].value(z.data());
  for (Eigen::Index i = 0; i < zeta.size(); ++i) *x++ = zeta_weight_ * source_weight_[i] * zeta[i];
}

/// √Σ (weight·value)² over the states.
template <class Value>
double KrylovSpace::norm_of_states(const Value& value) const {
  double square = 0.0;
  for (std::size_t i = 0; i < state_weight_.size(); ++i) square += std::pow(state_weight_[i] * value(descriptor_.states()[i]), 2);
  return std::sqrt(square);
}

double KrylovSpace::distance(const std::vector<double>& a, const std::vector<double>& b) const {
  return norm_of_states([&](const State& state) { return state.value(a.data()) - state.value(b.data()); });
}

double KrylovSpace::size_of_states(const std::vector<double>& z) const {
  return norm_of_states([&](const State& state) { return state.value(z.data()); });
}

/// The largest of |G| |z| in the rows of nodes.
double KrylovSpace::largest_conducted(const std::vector<double>& z) {
  sizes_.resize(z.size());
  for (std::size_t i = 0; i < z.size(); ++i) sizes_[i] = std::abs(z[i]);
  conducted_.resize(static_cast<std::size_t>(conduction_of_nodes_.pattern.size));
  linalg::multiply_transposed(conduction_of_nodes_, sizes_.data(), conducted_.data());
  return largest(conducted_);
}

/// Of the norm of a solution: voltages of stores are differences of those of nodes, and currents of inductors may be held by resistors between nodes, or move by the
/// difference of their voltages in 1/shift, all of which may be far larger.
double KrylovSpace::rounding_of_states(const std::vector<double>& z) {
  const auto nodes = static_cast<std::size_t>(descriptor_.nodes());
  const double voltage = largest(std::span(z).first(nodes));
  double rounding = voltage * (weight_of_voltages_ + weight_of_rates_ / shift_);
  if (weight_of_currents_ > 0.0) rounding += largest_conducted(z) * weight_of_currents_;
  return tolerance::solution_rounding * rounding;
}

/// The matrix into `values_`, once for a space.
void KrylovSpace::assemble() {
  if (is_assembled_) return;
  is_assembled_ = true;
  descriptor_.matrix(shift_, descriptor_.closing(shift_, on_, 0.0), 1.0, values_);
}

/// product_ := what `given_` and a solution d differ by.
void KrylovSpace::find_residual(const std::vector<double>& d) {
  assemble();
  product_.resize(d.size());
  linalg::multiply(descriptor_.pattern(), values_, d.data(), product_.data());
  for (std::size_t i = 0; i < d.size(); ++i) product_[i] = given_[i] - product_[i];
}

/// The same with sums in extended precision; the matrix is in `values_`.
void KrylovSpace::find_wide_residual(const std::vector<double>& d) {
  linalg::wide_residual(descriptor_.pattern(), values_, d, given_, wide_, product_);
}

/// Corrects a solution by its residual where the currents that charge capacitors leave others no digits: impulses of voltage of a floating part may be that large.
void KrylovSpace::refine(std::vector<double>& d, double counts) {
  is_refined_ = true;
  if (!factor_->is_as_it_stands() || !(weight_of_currents_ > 0.0)) return;
  sizes_.resize(d.size());
  descriptor_.memory_sizes(d.data(), sizes_.data());
  const double charging = shift_ * largest(std::span(sizes_).first(static_cast<std::size_t>(descriptor_.nodes())));
  is_refined_ = !(tolerance::solution_rounding * charging * weight_of_currents_ > counts);
  if (is_refined_ || begins_roughly_) return;
  is_refined_ = true;
  assemble();
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
  if (!(bound > counts) || !factor_->is_as_it_stands()) return bound;
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
  return tolerance::solution_rounding * norm_of_states([&](const State& state) { return state.size(z.data()); });
}

}  // namespace pwlsim::engine::sparse
