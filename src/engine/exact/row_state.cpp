#include "engine/exact/row_state.hpp"

#include <algorithm>
#include <cmath>

#include "engine/exact/tolerances.hpp"

namespace pwlsim::engine {

namespace {

/// A propagator for the row step is built when it has been wanted this often.
constexpr std::uint64_t worth_building = 4;
constexpr std::uint64_t rows_between_sources = 64;  ///< that oscillate or decay, evaluated anew

}  // namespace

void RowState::begin(const Segment& segment) {
  std::copy_n(segment.y0.begin(), static_cast<std::size_t>(segment.mode->ny), y_.begin());
  time_ = segment.anchor;
  late_ = segment.late;
  propagator_ = &propagators_[segment.mode];
  is_valid_ = true;
}

const double* RowState::at(const Segment& segment, const model::Exosystem::Phase& phase, double time) {
  if (!is_valid_) begin(segment);
  const model::Mode& mode = *segment.mode;
  const double step = (time - time_) - late_;
  if (std::abs(step - step_) <= tolerance::row_step * step_ && ++propagator_->uses >= worth_building) {
    advance_by_step(mode, time);
  } else if (time > time_) {  // a row at the segment's begin is what it begins with, however its time is rounded
    if (step > 0.0) mode.flow.apply(step, y_.data(), work_.data());
    time_ = time;
    late_ = 0.0;
  }
  // Over many rows without an event what each step rounds would add up.
  if (system_.exosystem->has_curved() && (system_.is_static() || ++rows_ % rows_between_sources == 0))
    system_.exosystem->evaluate_curved(phase, time, 0.0, y_.data() + mode.n1);
  return y_.data();
}

void RowState::advance_by_step(const model::Mode& mode, double time) {
  model::Matrix& propagator = propagator_->matrix;
  if (propagator.size() == 0) propagator = mode.flow.minus_identity(step_);
  advance(propagator, 1.0);
  time_ += step_;
  // A row's time is k·Tstep rounded; what adds up beyond that is made good.
  const double rest = (time - time_) - late_;
  if (std::abs(rest) > tolerance::row_time * time) {
    advance(mode.flow.a(), rest);
    time_ = time;
    late_ = 0.0;
  }
}

/// y += factor·M y.
void RowState::advance(const model::Matrix& m, double factor) {
  linalg::multiply(m, y_.data(), work_.data());
  for (Eigen::Index i = 0; i < m.rows(); ++i) y_[static_cast<std::size_t>(i)] += factor * work_[static_cast<std::size_t>(i)];
}

}  // namespace pwlsim::engine
