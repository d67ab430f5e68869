#include "engine/sparse/segment_deviation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/arithmetic.hpp"
#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

/// Vectors at which the error is looked at.
constexpr std::array<int, 13> deviation_dimensions{2, 3, 4, 5, 6, 8, 10, 13, 17, 22, 28, 35, 45};
/// Of the shift of the run's own segment: what an event leaves in decays that are far faster than the segment is no small part of a deviation, and a step that
/// goes past them tells little of it.
constexpr std::array<double, 5> shift_factors{1.0, 0x1p8, 0x1p16, 0x1p24, 0x1p32};
constexpr int smoothing_steps = 6;
constexpr double least_deviation_share = 1e-4;  ///< of a segment: a shorter part is none

}  // namespace

SegmentDeviation::SegmentDeviation(const Part& part)
    : part_(part),
      factors_(part.island.network, part.descriptor),
      sources_(part.island.network),
      space_(part.descriptor, sources_.exosystem()),
      zeta_(static_cast<std::size_t>(sources_.exosystem().size()), 0.0) {
  factors_.keep_digits();
}

bool SegmentDeviation::follow(const std::vector<SegmentRecord>& records, std::vector<double>& z) {
  z_ = z;
  more_.clear();
  worst_ = scale_ = 0.0;
  failure_.clear();
  beside_.clear();
  has_decayed_ = false;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (i == 0) {
      for (const Position& on : records[i].jumps)
        if (!project(records[i], on)) return false;
    } else if (!pass(records[i - 1], records[i])) {
      return false;
    }
    if (!propagate(records[i])) return false;
    if (has_decayed_) {
      std::fill(z.begin(), z.end(), 0.0);
      return true;
    }
  }
  z = z_;
  return true;
}

bool SegmentDeviation::smooth(const std::vector<SegmentRecord>& records, std::vector<double>& z) {
  if (records.empty()) return true;
  const SegmentRecord& first = records.front();
  scale_ = 0.0;
  more_.clear();
  for (int step = 0; step < smoothing_steps; ++step) {
    z_ = z;
    if (!open(first, first.on, first.shift, 1.0)) return false;
    if (is_gone()) return true;
    z = space_.first_unknowns();
  }
  return true;
}

/// The space of z_ and more_ in a position.
bool SegmentDeviation::open(const SegmentRecord& record, const Position& on, double shift, double length) {
  const Factor* factor = factors_.at(shift, on);
  space_.refine_all(record.refines);
  double unused = 0.0;
  const bool is_open = factor && space_.begin(*factor, shift, on, {z_, more_, zeta_}, scale_) == KrylovSpace::Begun::yes;
  if (!is_open) failure_ = fmt::format("a deviation does not fit the position at t = {} s", record.begin);
  more_.clear();
  if (is_open) scale_ = std::max(scale_, space_.start_size());
  return is_open && (length > 0.0 || resolve(1.0 / shift, unused));
}

/// Grows the space until its error is within the tolerance over the length, or over a part of it. Vectors that are nothing but rounding may make it worse.
bool SegmentDeviation::resolve(double length, double& reached) {
  reached = length;
  if (is_gone()) return true;
  double error = INFINITY;
  int best = 0;
  for (const int m : deviation_dimensions) {
    space_.grow(m);
    if (!space_.is_sound()) break;
    if (const double now = largest_error(length); now < error) {
      error = now;
      best = space_.dimension();
    }
    if (error <= tolerance::known_deviation * scale_ || space_.is_full()) break;
  }
  if (best == 0) return false;
  if (best < space_.dimension()) space_.shrink(best);
  const auto& points = space_.estimate(length);
  if (error > tolerance::known_deviation * scale_) {
    reached = 0.0;
    double part = 0.0;
    for (const auto& point : points) {
      if (!(point.error <= tolerance::known_deviation * scale_)) break;
      reached = point.tau;
      part = std::max(part, point.error);
    }
    if (reached < least_deviation_share * length && error <= tolerance::rounded_deviation * scale_) reached = length;
    if (reached < length) error = part;
  }
  if (reached < least_deviation_share * length) return false;
  worst_ = std::max(worst_, error / scale_);
  return error <= tolerance::rounded_deviation * scale_;
}

double SegmentDeviation::largest_error(double length) {
  double error = 0.0;
  for (const auto& point : space_.estimate(length)) error = std::max(error, point.error);
  return error;
}

/// The space of what is left of a segment, as far as it reaches. False: failed.
bool SegmentDeviation::open_rest(const SegmentRecord& record, double done, double& reached) {
  const double left = record.length - done;
  const std::vector<double> more = more_;
  for (const double factor : shift_factors) {
    more_ = more;
    if (!open(record, record.on, factor * record.shift, std::max(left, 0.0) + 1.0)) return false;
    has_decayed_ = is_gone();
    if (has_decayed_ || resolve(left > 0.0 ? left : 1.0 / record.shift, reached)) return true;
  }
  failure_ = fmt::format("a deviation cannot be followed from t = {} s on", record.begin + done);
  return false;
}

bool SegmentDeviation::propagate(const SegmentRecord& record) {
  for (double done = 0.0;;) {
    double reached = 0.0;
    if (!open_rest(record, done, reached)) return false;
    if (has_decayed_) return true;
    y_.assign(space_.first().begin(), space_.first().end());
    work_.resize(2 * y_.size());
    const double left = record.length - done, step = std::min(reached, std::max(left, 0.0));
    space_.flow().apply_once(step, y_.data(), work_.data());
    space_.unknowns(y_.data(), z_);
    done += step;
    if (step >= left) return true;
  }
}

bool SegmentDeviation::is_gone() const { return !(space_.start_size() > tolerance::decayed_deviation * scale_); }

/// A jump in a position, of the deviation.
bool SegmentDeviation::project(const SegmentRecord& record, const Position& on) {
  if (!open(record, on, record.shift, 0.0)) return false;
  if (is_gone()) return true;
  y_.assign(space_.first().begin(), space_.first().end());
  space_.unknowns(y_.data(), z_);
  return true;
}

bool SegmentDeviation::pass(const SegmentRecord& before, const SegmentRecord& after) {
  if (before.ends_unknown && before.on != after.on) {
    failure_ = fmt::format("the search for events could not decide at t = {} s", after.begin);
    return false;
  }
  double shift = 0.0;
  if (!before.guards.empty() && (before.on != after.on || !after.jumps.empty())) {
    const FallingGuard& guard = before.guards.front();
    const double change = Form::sum(guard.form.z, z_.data());
    if (!(std::abs(guard.rate) > 0.0) && change != 0.0) {
      failure_ = fmt::format("{} touches its threshold at t = {} s", part_.descriptor.ports()[guard.port].name, after.begin);
      return false;
    }
    if (change != 0.0) shift = -change / guard.rate;
    note_beside(before, after, shift);
  }
  const auto add = [&](double factor, const std::vector<double>& rates) {
    if (factor == 0.0) return;
    more_.resize(rates.size(), 0.0);
    for (std::size_t i = 0; i < rates.size(); ++i) more_[i] += factor * rates[i];
  };
  add(shift, before.rates_at_end);
  for (const Position& on : after.jumps)
    if (!project(after, on)) return false;
  add(-shift, after.rates_at_begin);
  return true;
}

/// Others that change sides there, which another change of the start would take to zero at another time.
void SegmentDeviation::note_beside(const SegmentRecord& before, const SegmentRecord& after, double shift) {
  for (std::size_t i = 1; i < before.guards.size(); ++i) {
    const FallingGuard& guard = before.guards[i];
    if (before.on[guard.port] == after.on[guard.port]) continue;
    const double own = -Form::sum(guard.form.z, z_.data()) / guard.rate;
    const double terms = Form::size_of(guard.form.z, z_.data()) / std::abs(guard.rate);
    if (std::abs(own - shift) > tolerance::same_shift_of_time * std::max(terms, std::abs(shift)))
      beside_.push_back({after.begin, part_.descriptor.ports()[guard.port].name});
  }
}

}  // namespace pwlsim::engine::sparse
