#include "engine/exact/modal_search.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "engine/exact/bent_step.hpp"
#include "engine/exact/tolerances.hpp"

namespace pwlsim::engine {

namespace {

using Complex = std::complex<double>;

constexpr double short_interval = 2.0;  ///< |λ|·h up to which a term is enclosed by its second derivative
constexpr double series_reach = 0.5;    ///< |λ|·τ up to which e₂ is summed: beyond, differences lose next to nothing
/// Terms of that sum by the exponent of |λ|·τ, to rounding.
constexpr std::array<int, 6> series_terms{13, 10, 9, 8, 7, 6};
constexpr int fewest_terms = 5;
constexpr int most_search_depth = 40;  ///< of halving
constexpr std::uint64_t most_searched_intervals = 1000;
constexpr std::size_t most_guards = 64;
constexpr double beyond_last_root = 1.25;  ///< where a root is looked for, against where the last one was
constexpr int most_polishing_steps = 60;

constexpr std::array<double, 16> reciprocal = [] {
  std::array<double, 16> table{};
  for (std::size_t i = 1; i < table.size(); ++i) table[i] = 1.0 / static_cast<double>(i);
  return table;
}();

double real_of(const Complex& a, const Complex& b) { return a.real() * b.real() - a.imag() * b.imag(); }

/// Without the treatment of infinities that the operator has.
Complex product(const Complex& a, const Complex& b) { return {real_of(a, b), a.real() * b.imag() + a.imag() * b.real()}; }

/// Second derivative times this is how far a function strays from its chord.
double off_chord(double h) { return 0.125 * h * h; }

}  // namespace

void ModalSearch::evaluate(const model::ModalRate& rate, double tau, Exponents& out) {
  const Complex x = rate.value * tau;
  const double square = std::norm(x);
  if (square > series_reach * series_reach) {
    out.size = std::exp(x.real());
    if (rate.is_real) {
      out.e0 = out.size;
      out.e1 = (out.size - 1.0) * rate.inverse.real();
      out.e2 = (out.e1.real() - tau) * rate.inverse.real();
    } else {
      out.e0 = {out.size * std::cos(x.imag()), out.size * std::sin(x.imag())};
      out.e1 = product(out.e0 - 1.0, rate.inverse);
      out.e2 = product(out.e1 - tau, rate.inverse);
    }
    return;
  }
  // Half its binary exponent: |x| < 2^-(below + 1).
  const int below = square > 0.0 ? -(std::ilogb(square) + 1) / 2 - 1 : most_search_depth;
  const int terms =
      below < static_cast<int>(series_terms.size()) ? series_terms[static_cast<std::size_t>(std::max(below, 0))] : fewest_terms;
  if (rate.is_real) {
    double sum = 1.0;
    for (int j = terms; j >= 1; --j) sum = 1.0 + sum * x.real() * reciprocal[static_cast<std::size_t>(j + 2)];
    out.e2 = 0.5 * tau * tau * sum;
    out.e1 = tau + rate.value.real() * out.e2.real();
    out.e0 = out.size = 1.0 + rate.value.real() * out.e1.real();
  } else {
    Complex sum{1.0};
    for (int j = terms; j >= 1; --j) sum = product(sum, x) * reciprocal[static_cast<std::size_t>(j + 2)] + 1.0;
    out.e2 = sum * (0.5 * tau * tau);
    out.e1 = product(rate.value, out.e2) + tau;
    out.e0 = product(rate.value, out.e1) + 1.0;
    out.size = std::sqrt(std::norm(out.e0));
  }
}

void ModalSearch::evaluate(double tau, Exponents* out) const {
  for (std::size_t k = 0; k < count_; ++k) {
    const model::ModalRate& rate = form_->rates[k];
    Exponents& e = out[k];
    evaluate(rate, tau, e);
    e.growth = std::max(1.0, e.size);
    e.lasting = std::min(tau, 2.0 * rate.time);
    const bool has_decayed = rate.decay_time > 0.0 && tau > rate.decay_time;
    e.moving = has_decayed ? rate.decay_time : tau * e.growth;
  }
}

void ModalSearch::make_room(std::size_t guards) {
  const auto rows = static_cast<std::size_t>(form_->velocities.rows() + form_->velocities.cols());
  if (z_.size() < rows) {
    for (auto* v : {&z_, &push_, &size_, &error_}) v->resize(rows);
  }
  if (points_.size() < count_ * (most_search_depth + 3)) {
    points_.resize(count_ * (most_search_depth + 3));
    trial_.resize(count_);
  }
  if (coefficients_.size() < guards * count_) coefficients_.resize(guards * count_);
  if (drift_.size() < guards) drift_.resize(guards);
}

/// Coefficients of every guard.
void ModalSearch::begin(std::span<const Guard> guards, const double* y) {
  make_room(guards.size());
  const model::ModalForm& form = *form_;
  const auto rows = static_cast<std::size_t>(form.velocities.rows());
  const Eigen::Index ny = form.velocities.cols();
  double* magnitudes = &size_[rows];
  for (Eigen::Index i = 0; i < ny; ++i) magnitudes[i] = std::abs(y[i]);
  linalg::multiply(form.velocities, y, z_.data());
  linalg::multiply(form.pushes, y, push_.data());
  linalg::multiply(form.absolute_velocities, magnitudes, size_.data());
  const bool has_errors = form.velocity_errors.rows() > 0;
  if (has_errors) linalg::multiply(form.velocity_errors, magnitudes, error_.data());
  for (std::size_t g = 0; g < guards.size(); ++g) {
    drift_[g] = linalg::row_times(form.drift, guards[g].row, y);
    const double* weights = &form.weights(0, guards[g].row);
    const double* weight_sizes = &form.weight_sizes(0, guards[g].row);
    for (std::size_t k = 0; k < count_; ++k) {
      const model::ModalRate& rate = form.rates[k];
      Coefficients& c = coefficients_[g * count_ + k];
      if (rate.is_real) {
        c.velocity = weights[2 * k] * z_[2 * k];
        c.push = weights[2 * k] * push_[2 * k];
        c.bend = rate.value.real() * c.velocity.real() + c.push.real();
        c.bend_size = std::abs(c.bend.real());
      } else {
        const Complex p{weights[2 * k], weights[2 * k + 1]};
        c.velocity = product(p, {z_[2 * k], z_[2 * k + 1]});
        c.push = product(p, {push_[2 * k], push_[2 * k + 1]});
        c.bend = product(rate.value, c.velocity) + c.push;
        c.bend_size = std::sqrt(std::norm(c.bend));
      }
      c.noise = tolerance::coordinate * weight_sizes[k] * (size_[2 * k] + size_[2 * k + 1]);
      if (has_errors) c.noise += weight_sizes[k] * (error_[2 * k] + error_[2 * k + 1]);
    }
  }
}

/// What rounding leaves of a guard and its slope anywhere in the interval: from z' and f', and from the phase λτ of what moves on.
ModalSearch::Noise ModalSearch::noise_of(std::size_t guard, const Interval& in) const {
  const Coefficients* c = &coefficients_[guard * count_];
  const double drift = tolerance::unit_rounding * std::abs(drift_[guard]);
  Noise noise{guards_[guard].noise + drift * in.right, drift};
  for (std::size_t k = 0; k < count_; ++k) {
    const Exponents& at = in.at_right[k];
    const double push = tolerance::coordinate * (std::abs(c[k].push.real()) + std::abs(c[k].push.imag()));
    const double phase = tolerance::unit_rounding * c[k].bend_size * at.moving;
    noise.slope += at.growth * (c[k].noise + push * at.lasting) + phase;
    noise.value += (at.growth * (c[k].noise + push * in.right) + phase) * at.lasting;
  }
  return noise;
}

double ModalSearch::value(std::size_t guard, double tau, const Exponents* at) const {
  const Coefficients* c = &coefficients_[guard * count_];
  double sum = guards_[guard].value + drift_[guard] * tau;
  for (std::size_t k = 0; k < count_; ++k) sum += real_of(c[k].velocity, at[k].e1) + real_of(c[k].push, at[k].e2);
  return sum;
}

double ModalSearch::slope(std::size_t guard, const Exponents* at) const {
  const Coefficients* c = &coefficients_[guard * count_];
  double sum = drift_[guard];
  for (std::size_t k = 0; k < count_; ++k) sum += real_of(c[k].velocity, at[k].e0) + real_of(c[k].push, at[k].e1);
  return sum;
}

ModalSearch::Bend ModalSearch::bend(std::size_t guard, const Exponents* at) const {
  const Coefficients* c = &coefficients_[guard * count_];
  Bend sum;
  for (std::size_t k = 0; k < count_; ++k) {
    const Complex own = product(c[k].bend, at[k].e0);
    sum.second += own.real();
    sum.third += real_of(own, form_->rates[k].value);
  }
  return sum;
}

/// A straight line below the guard, at its lower end. `line` is the chord, and is lowered.
double ModalSearch::least_value(std::size_t guard, const Interval& in, Line line) const {
  const Coefficients* c = &coefficients_[guard * count_];
  const double h = in.right - in.left;
  for (std::size_t k = 0; k < count_; ++k) {
    const model::ModalRate& rate = form_->rates[k];
    if (rate.is_real && c[k].bend.real() <= 0.0) continue;  // above its chord
    const double bend = c[k].bend_size * std::max(in.at_left[k].size, in.at_right[k].size);
    if (rate.size * h <= short_interval || (rate.is_real && rate.value.real() > 0.0)) {
      line.at_left -= bend * off_chord(h);
      line.at_right -= bend * off_chord(h);
    } else if (rate.is_real) {  // above its tangent at the right end
      const double change = c[k].velocity.real() * (in.at_right[k].e1.real() - in.at_left[k].e1.real()) +
                            c[k].push.real() * (in.at_right[k].e2.real() - in.at_left[k].e2.real());
      const double end_slope = c[k].velocity.real() * in.at_right[k].e0.real() + c[k].push.real() * in.at_right[k].e1.real();
      line.at_left -= std::max(0.0, end_slope * h - change);
    } else {  // within its own magnitude about a straight line
      const Complex own = product(c[k].bend, product(rate.inverse, rate.inverse));
      const double most = bend * rate.time * rate.time;
      line.at_left -= real_of(own, in.at_left[k].e0) + most;
      line.at_right -= real_of(own, in.at_right[k].e0) + most;
    }
  }
  return line.least();
}

/// Straight lines below and above its slope.
void ModalSearch::bound_slope(std::size_t guard, const Interval& in, Line& least, Line& most) const {
  const Coefficients* c = &coefficients_[guard * count_];
  const double h = in.right - in.left;
  least = most = {slope(guard, in.at_left), slope(guard, in.at_right)};
  for (std::size_t k = 0; k < count_; ++k) {
    const model::ModalRate& rate = form_->rates[k];
    const double bend = c[k].bend_size * std::max(in.at_left[k].size, in.at_right[k].size);
    const bool is_convex = c[k].bend.real() * rate.value.real() > 0.0;
    double left = 0.0, right = 0.0;  // how far it may be from its chord
    if (rate.size * h <= short_interval || (rate.is_real && rate.value.real() > 0.0)) {
      left = right = bend * rate.size * off_chord(h);
    } else if (rate.is_real) {
      const double change = c[k].velocity.real() * (in.at_right[k].e0.real() - in.at_left[k].e0.real()) +
                            c[k].push.real() * (in.at_right[k].e1.real() - in.at_left[k].e1.real());
      left = std::abs(c[k].bend.real() * in.at_right[k].e0.real() * h - change);
    } else {
      const Complex own = product(c[k].bend, rate.inverse);
      const double at_left = real_of(own, in.at_left[k].e0), at_right = real_of(own, in.at_right[k].e0), both = bend * rate.time;
      least.at_left -= at_left + both;
      least.at_right -= at_right + both;
      most.at_left += both - at_left;
      most.at_right += both - at_right;
      continue;
    }
    if (!rate.is_real || is_convex) {
      least.at_left -= left;
      least.at_right -= right;
    }
    if (!rate.is_real || !is_convex) {
      most.at_left += left;
      most.at_right += right;
    }
  }
}

ModalSearch::Verdict ModalSearch::judge(std::size_t g, const Interval& in) {
  const bool leaves_zero = guards_[g].leaves_zero && in.left == 0.0;
  const Noise noise = noise_of(g, in);
  Line chord;
  if (!leaves_zero) {
    chord.at_left = value(g, in.left, in.at_left);
    is_stuck_ |= chord.at_left <= guards_[g].noise;
    if (!(chord.at_left > noise.value)) return Verdict::undecided;
    chord.at_right = value(g, in.right, in.at_right);
    if (least_value(g, in, chord) > noise.value) return Verdict::positive;
  }
  Line least, most;
  bound_slope(g, in, least, most);
  if (least.least() > noise.slope) return Verdict::positive;
  if (leaves_zero || !(most.most() < -noise.slope)) return Verdict::undecided;
  if (chord.at_right > noise.value) return Verdict::positive;
  return chord.at_right < -noise.value ? Verdict::root : Verdict::undecided;
}

/// Chebyshev's method kept inside the interval.
double ModalSearch::root(std::size_t g, const Interval& in) {
  double low = in.left, high = in.right;
  const double at_low = value(g, low, in.at_left), at_high = value(g, high, in.at_right);
  double at = low + (high - low) * at_low / (at_low - at_high);
  for (int i = 0; i < most_polishing_steps; ++i) {
    evaluate(at, trial_.data());
    const double now = value(g, at, trial_.data());
    (now > 0.0 ? low : high) = at;
    const double steepness = slope(g, trial_.data());
    const Bend curvature = bend(g, trial_.data());
    const double newton = -now / steepness, bent = 0.5 * newton * curvature.second / steepness;
    const double next = at + newton * bend_factor(bent);
    const bool inside = i < most_bent_steps && next > low && next < high;
    at = inside ? next : 0.5 * (low + high);
    // What it leaves for the next one, to leading order.
    const double left = 2.0 * bent * bent + newton * newton * std::abs(curvature.third / (6.0 * steepness));
    if (inside && std::abs(newton) * left <= tolerance::modal_root_step * at) break;
  }
  return at;
}

/// Of guards that fall throughout the interval and are below zero at its end.
ModalSearch::Found ModalSearch::first_root(const Interval& in, std::uint64_t falling) {
  Found found{Verdict::root, 0, in.left, in.right, in.right};
  for (bool any = false; falling != 0; falling &= falling - 1, any = true) {
    const auto g = static_cast<std::size_t>(std::countr_zero(falling));
    if (any) {
      evaluate(found.at, trial_.data());
      if (value(g, found.at, trial_.data()) > 0.0) continue;
    }
    found.guard = g;
    found.at = root(g, in);
  }
  return found;
}

ModalSearch::Found ModalSearch::examine(const Interval& in, std::uint64_t open, int depth) {
  ++intervals_;
  std::uint64_t falling = 0, undecided = 0;
  for (std::uint64_t left = open; left != 0; left &= left - 1) {
    const auto g = static_cast<std::size_t>(std::countr_zero(left));
    const std::uint64_t bit = left & (~left + 1);
    const Verdict verdict = judge(g, in);
    if (verdict == Verdict::root) falling |= bit;
    if (verdict == Verdict::undecided) undecided |= bit;
  }
  if ((undecided | falling) == 0) {
    positive_until_ = in.right;
    return {Verdict::positive};
  }
  if (undecided == 0) return first_root(in, falling);
  if (is_stuck_ || depth == most_search_depth || intervals_ >= last_interval_) return {Verdict::undecided, 0, positive_until_};
  const double middle = 0.5 * (in.left + in.right);
  Exponents* at_middle = &points_[static_cast<std::size_t>(depth + 2) * count_];
  evaluate(middle, at_middle);
  const Found first = examine({in.left, middle, in.at_left, at_middle}, undecided | falling, depth + 1);
  if (first.verdict != Verdict::positive) return first;
  return examine({middle, in.right, at_middle, in.at_right}, undecided | falling, depth + 1);
}

/// Up to where the slowest oscillation has turned: an interval that goes beyond is seldom decided.
double ModalSearch::turn() const {
  double time = 0.0;
  for (const model::ModalRate& rate : form_->rates)
    if (!rate.is_real) time = std::max(time, rate.time);
  return time > 0.0 ? short_interval * time : INFINITY;
}

ModalSearch::Found ModalSearch::search(const model::ModalForm& form, std::span<const Guard> guards, const double* y, double h) {
  if (guards.size() > most_guards) return {};
  form_ = &form;
  guards_ = guards;
  count_ = form.rates.size();
  positive_until_ = 0.0;
  is_stuck_ = false;
  last_interval_ = intervals_ + most_searched_intervals;
  begin(guards, y);
  Exponents *at_left = points_.data(), *at_right = at_left + count_;
  std::fill_n(at_left, count_, Exponents{1.0, 0.0, 0.0, 1.0});
  const std::uint64_t all = guards.size() == most_guards ? ~std::uint64_t{0} : (std::uint64_t{1} << guards.size()) - 1;

  double length = form.last_root > 0.0 ? beyond_last_root * form.last_root : h;
  if (const double short_one = turn(); form.last_root == 0.0 && short_one < h) {
    evaluate(h, at_right);
    const Found whole = examine({0.0, h, at_left, at_right}, all, most_search_depth);
    if (whole.verdict != Verdict::undecided || is_stuck_) return whole;
    length = short_one;
  }
  for (double left = 0.0;; length *= 2.0) {
    const double right = h - left < 2.0 * length ? h : left + length;
    evaluate(right, at_right);
    const Found found = examine({left, right, at_left, at_right}, all, 0);
    if (found.verdict == Verdict::root) form.last_root = found.at;
    if (found.verdict != Verdict::positive || right == h) return found;
    std::copy_n(at_right, count_, at_left);
    left = right;
  }
}

}  // namespace pwlsim::engine
