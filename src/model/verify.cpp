#include "model/verify.hpp"

#include <algorithm>
#include <cmath>

#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

constexpr double share_of_state_norm = 0.1;
/// Of decays: as long as they may hold a guard.
constexpr double time_constants_unresolved = 4.0;

/// Whether the decays move a guard at all: one that they do not reach has no lag.
bool reads_decays(const Mode& mode, int row) { return mode.decays->guards.row(row).norm() > tolerance::noise_floor * mode.guard_norm[row]; }

}  // namespace

void Verifier::extend(const Mode& mode, int order) {
  const auto ny = static_cast<std::size_t>(ny_);
  while (known_ <= order) {
    const auto from = static_cast<std::size_t>(known_ - 1) * ny;
    const auto to = static_cast<std::size_t>(known_) * ny;
    if (z_.size() < to + ny) {
      z_.resize(to + ny);
      size_.resize(to + ny);
    }
    if (norm_.size() <= static_cast<std::size_t>(known_)) norm_.resize(static_cast<std::size_t>(known_) + 1);
    linalg::multiply(mode.flow.a(), &z_[from], &z_[to]);
    linalg::multiply(mode.absolute_a, &size_[from], &size_[to]);
    const double scale = mode.norm_a > 0.0 ? 1.0 / mode.norm_a : 0.0;
    for (std::size_t i = 0; i < ny; ++i) {
      z_[to + i] *= scale;
      size_[to + i] *= scale;
    }
    norm_[static_cast<std::size_t>(known_)] = linalg::norm(&z_[to], ny_);
    ++known_;
  }
}

/// Rounding of a guard's derivative whose terms sum up to `size` in magnitude.
double Verifier::rounding(const Mode& mode, int row, int order, double size) const {
  const double norm = norm_[static_cast<std::size_t>(order)];
  if (mode.apart) {  // of φ, `size` has the terms
    const FastCoordinates& apart = *mode.apart;
    const double* z = &z_[static_cast<std::size_t>(order * ny_)];
    size += share_of_state_norm *
            (apart.slow_guard_norm[row] * norm + apart.guard_norm[row] * linalg::norm(z + apart.first, mode.n1 - apart.first) +
             apart.source_guard_norm[row] * linalg::norm(z + mode.n1, ny_ - mode.n1));
  } else {
    size += share_of_state_norm * mode.guard_norm[row] * norm;
  }
  double bound = std::min(mode.guard_noise[row], std::max(mode.noise, tolerance::most_guard_noise)) * size;
  if (mode.guard_error.size() > 0)
    bound = std::min(bound, guard_rounding(mode, row, &z_[static_cast<std::size_t>(order * ny_)], size, 0.0));
  bound *= relaxation_;
  if (relaxation_ > 1.0) bound += relaxation_ * tolerance::remainder_of_decay * mode.guard_norm[row] * largest_;
  return bound;
}

bool Verifier::significant(const Mode& mode, int row, int order, double& value) {
  if (order >= known_) extend(mode, order);
  const double* z = &z_[static_cast<std::size_t>(order * ny_)];
  const double* size = &size_[static_cast<std::size_t>(order * ny_)];
  const auto rows = mode.guards.rows();
  const double* g = mode.guards.data() + row;
  double sum = 0.0;
  double bound = 0.0;
  for (int i = 0; i < ny_; ++i, g += rows) {
    sum += *g * z[i];
    bound += std::abs(*g) * size[i];
  }
  value = sum;
  return std::abs(sum) > rounding(mode, row, order, bound);
}

Departure Verifier::departure(const Mode& mode, int row) {
  if (mode.guard_norm[row] == 0.0) return {-1, 0.0};
  double scale = 1.0;
  for (int order = 1; order <= ny_; ++order) {
    scale *= mode.norm_a;
    double value = 0.0;
    if (significant(mode, row, order, value)) return {order, value * scale};
  }
  return {-1, 0.0};
}

/// Whether decays may hold a guard that is below zero now and moves at the rate `next`.
bool Verifier::may_be_held(const Mode& mode, int row, const Departure& now, double next) const {
  const Decays& decays = *mode.decays;
  const double time = time_constants_unresolved * decays.slowest;
  // A parabola that dips no deeper than the guard's own rounding has not crossed either.
  const double zero = rounding(mode, row, 0, values_[static_cast<std::size_t>(mode.guards.rows() + row)]);
  if (now.order == 1 && next > 0.0 && now.value * now.value <= 2.0 * next * zero) return true;
  if (!(-now.value <= time * std::abs(next))) return false;
  if (time_constants_to_rest * decays.slowest <= unseen_) return true;
  if (now.order != 0 || !left_ || left_->size() != decays.guards.cols()) return false;
  // Where the guard was zero when the slow motion was entered, the two are equal but for rounding.
  const double whole_zero = relaxation_ * decays.guard_rounding[row] * norm_[0];
  return -now.value <= decays.guards.row(row).cwiseAbs().dot(left_->cwiseAbs()) + whole_zero;
}

/// A guard that leaves zero upwards and is undone by its next derivative before the decays, which the slow motion does not resolve, are over: it falls. The slow motion's lag
/// behind a voltage that begins to rise has the sign that this voltage does not have.
Departure Verifier::undone(const Mode& mode, int row, Departure first) {
  if (first.order < 1 || first.order >= ny_ || !reads_decays(mode, row)) return first;
  if (known_ == 0) prepare();
  double next = 0.0;
  if (!significant(mode, row, first.order + 1, next)) return first;
  next *= std::pow(mode.norm_a, first.order + 1);
  const double time = time_constants_unresolved * mode.decays->slowest;
  return next < 0.0 && first.value <= time * -next ? Departure{first.order + 1, next} : first;
}

/// What is there once the decays beside a slow motion are over: a guard below zero by what it makes good meanwhile rises.
Departure Verifier::after_decays(const Mode& mode, int row, Departure first) {
  if (!mode.decays) return first;
  if (first.value > 0.0) return undone(mode, row, first);
  if (!(first.value < 0.0)) return first;
  if (known_ == 0) prepare();
  double scale = std::pow(mode.norm_a, first.order);
  for (Departure d = first; d.value < 0.0 && d.order < ny_;) {
    double next = 0.0;
    if (!significant(mode, row, d.order + 1, next)) return first;
    scale *= mode.norm_a;
    next *= scale;
    if (!may_be_held(mode, row, d, next)) return first;
    d = {d.order + 1, next};
    if (next > 0.0) return undone(mode, row, d);
  }
  return first;
}

/// Values of all guards at once: few need more than a look, and fewer a derivative.
void Verifier::take(const Mode& mode, const double* y) {
  mode_ = &mode;
  ny_ = mode.ny;
  known_ = 0;
  const auto ny = static_cast<std::size_t>(ny_), guards = static_cast<std::size_t>(mode.guards.rows());
  if (z_.size() < ny) {
    z_.resize(ny);
    size_.resize(ny);
  }
  if (values_.size() < 2 * guards) values_.resize(2 * guards);
  linalg::copy(y, ny_, z_.data());
  linalg::multiply(mode.guards, y, values_.data());
}

/// What is needed of a state at which some guard is near to zero.
void Verifier::prepare() {
  const Mode& mode = *mode_;
  if (norm_.empty()) norm_.resize(1);
  const double c_norm = linalg::norm(z_.data(), mode.n1);
  const int slow = mode.apart ? mode.apart->first : mode.n1;
  for (int i = 0; i < ny_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    size_[k] = std::abs(z_[k]) + (i < slow ? share_of_state_norm * c_norm : 0.0);
  }
  for (int i = slow; i < mode.n1; ++i)
    size_[static_cast<std::size_t>(i)] += linalg::absolute_row_times(mode.apart->terms, i - slow, z_.data());
  norm_[0] = linalg::norm(z_.data(), ny_);
  known_ = 1;
  linalg::multiply(mode.absolute_guards, size_.data(), values_.data() + mode.guards.rows());
}

/// Square of the most that the rounding of a guard's value can be, in units of the guard's norm.
double Verifier::square_of_most_rounding(const Mode& mode, const double* y) const {
  if (relaxation_ > 1.0) return INFINITY;
  const double most =
      mode.guard_noise.maxCoeff() * (1.0 + share_of_state_norm * (1.0 + mode.n1) + (mode.apart ? mode.apart->terms_norm : 0.0));
  return most * most * linalg::square(y, mode.ny);
}

void Verifier::departures(const Mode& mode, const double* y, const std::vector<int>& rows, Departure* out) {
  if (mode_ != &mode || !std::equal(y, y + mode.ny, z_.data())) take(mode, y);
  const auto guards = static_cast<std::size_t>(mode.guards.rows());
  const double most = square_of_most_rounding(mode, y);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto row = static_cast<std::size_t>(rows[i]);
    const double value = values_[row];
    const double norm = mode.guard_norm[rows[i]];
    if (value * value > most * (norm * norm)) {
      out[i] = after_decays(mode, rows[i], {0, value});
      continue;
    }
    if (known_ == 0) prepare();
    const bool decided = std::abs(value) > rounding(mode, rows[i], 0, values_[guards + row]);
    out[i] = after_decays(mode, rows[i], decided ? Departure{0, value} : departure(mode, rows[i]));
  }
}

}  // namespace pwlsim::model
