#include "model/clock.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/arithmetic.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

constexpr int most_corners = 1024;  ///< passed at once, so that a run can be interrupted

}  // namespace

bool Clock::can_drive(const System& system, const Control& control) {
  const Exosystem& sources = *system.exosystem;
  Vector others = control.value.state;
  const double noise = others.size() > 0 ? tolerance::row_entry * others.cwiseAbs().maxCoeff() : 0.0;
  if (sources.constant() >= 0) others[system.n + sources.constant()] = 0.0;
  for (const auto& track : sources.tracks())
    if (track.channel < 0) others[system.n + sources.blocks()[static_cast<std::size_t>(track.block)].first] = 0.0;
  const auto is_rounding = [noise](const Vector& row) { return row.size() == 0 || row.cwiseAbs().maxCoeff() <= noise; };
  return is_rounding(others) && is_rounding(control.value.input);
}

Clock::Clock(const System& system, const Control& control, double tolerance)
    : on_level_(control.on_level), off_level_(control.off_level), tolerance_(tolerance), driven_(control.driven) {
  const Exosystem& sources = *system.exosystem;
  if (sources.constant() >= 0) constant_ = control.value.state[system.n + sources.constant()];
  for (const auto& [track, block, may_jump, channel] : sources.tracks()) {
    const double gain = control.value.state[system.n + sources.blocks()[static_cast<std::size_t>(block)].first];
    if (gain != 0.0) terms_.push_back({{system.exosystem, &track}, gain, may_jump});
  }
}

Clock::Clock(std::vector<Term> terms, double constant, double on_level, double off_level, int driven, double tolerance)
    : terms_(std::move(terms)), constant_(constant), on_level_(on_level), off_level_(off_level), tolerance_(tolerance), driven_(driven) {}

Clock::Margin Clock::margin_at(double time, double late) const {
  const double level = is_on_ ? off_level_ : on_level_;
  double value = constant_ - level;
  double slope = 0.0, slope_size = 0.0;
  double size = std::abs(constant_) + std::abs(level);
  for (const Term& term : terms_) {
    value += term.gain * term.cursor.at(time, late);
    size += std::abs(term.gain) * term.cursor.size_at(time);
    slope += term.gain * term.cursor.slope;
    slope_size += std::abs(term.gain * term.cursor.slope);
  }
  if (std::abs(slope) <= threshold_noise * slope_size) slope = 0.0;
  const double sign = is_on_ ? 1.0 : -1.0;
  return {sign * value, sign * slope, threshold_noise * size, is_on_ && on_level_ == off_level_};
}

void Clock::start(bool is_on, double time) {
  is_on_ = is_on;
  for (Term& term : terms_) term.cursor = term.track->before(time);
  pass(time, 0.0);
  if (terms_.size() == 1) recurrences_.assign(4 * terms_[0].track->loop.size(), {});
  search();
}

void Clock::take() {
  is_on_ ^= next_.flips;
  Recurrence* known = recurrence();
  if (known && known->is_known) return repeat(*known);
  finish_cursor();
  if (!known) return search();
  const Track::Cursor before = terms_[0].cursor;
  search();
  const Track::Cursor& now = terms_[0].cursor;
  const auto segments = static_cast<double>(terms_[0].track->loop.size());
  const double passed =
      (now.period_index - before.period_index) * segments + static_cast<double>(now.item) - static_cast<double>(before.item);
  if (passed > segments) return;
  *known = {true, static_cast<int>(passed), (from_ - now.start) + (late_ - now.start_late), next_.flips, next_.is_edge, inside_};
}

/// Where the clock stands in a period that is followed by another one; none elsewhere.
Clock::Recurrence* Clock::recurrence() {
  if (recurrences_.empty()) return nullptr;
  const Track& track = *terms_[0].track;
  const Track::Cursor& cursor = terms_[0].cursor;
  if (cursor.item < track.prefix.size() || cursor.period_index < 1.0 || cursor.period_index + 2.0 > track.loop_count) return nullptr;
  const std::size_t item = cursor.item - track.prefix.size();
  return &recurrences_[4 * item + 2 * static_cast<std::size_t>(is_on_) + static_cast<std::size_t>(inside_)];
}

void Clock::repeat(const Recurrence& known) {
  Term& term = terms_[0];
  if (known.passed > 0) {
    term.track->pass_in_loop(term.cursor, known.passed);
    has_next_ = false;
  }
  inside_ = known.crosses;
  from_ = term.cursor.start;
  late_ = term.cursor.start_late;
  if (inside_) {
    const double tau = late_ + known.tau;
    late_ = rounding_of_sum(from_, tau);
    from_ += tau;
  }
  next_ = {from_, late_, known.flips, known.is_edge};
}

/// What `repeat` leaves out of its track's cursor.
void Clock::finish_cursor() {
  if (!has_next_) terms_[0].track->set_next(terms_[0].cursor);
  has_next_ = true;
}

/// Takes the breakpoints at `time`; true if a source jumped there.
bool Clock::pass(double time, double late) {
  bool jumped = false;
  for (Term& term : terms_)
    if (term.cursor.next <= time + tolerance_) jumped |= term.track->pass(term.cursor, time, tolerance_) && term.may_jump;
  from_ = time;
  late_ = late;
  inside_ = false;
  return jumped;
}

void Clock::search() {
  next_ = {from_, late_, false, false};
  for (int corners = 0; corners < most_corners; ++corners) {
    const Margin margin = margin_at(from_, late_);
    next_.flips = margin.departs();
    if (next_.flips || next_.is_edge) return;
    next_ = {forever, 0.0, false, false};
    for (const Term& term : terms_)
      if (term.cursor.next < next_.time) next_ = {term.cursor.next, term.cursor.next_late, false, false};
    if (margin.slope < 0.0 && cross_before(next_.time, next_.late, margin)) return;
    if (next_.time == forever) return;
    next_.is_edge = pass(next_.time, next_.late);
  }
}

void Clock::trace(double stop, std::size_t most, const std::function<void(const Line&)>& see) const {
  Clock own = *this;
  own.is_on_ = true;  // the margin is then the control itself
  own.on_level_ = own.off_level_ = 0.0;
  for (Term& term : own.terms_) term.cursor = term.track->before(0.0);
  own.pass(0.0, 0.0);
  for (std::size_t lines = 0; lines < most && own.from_ < stop; ++lines) {
    double next = stop, next_late = 0.0;
    for (const Term& term : own.terms_)
      if (term.cursor.next < next) {
        next = term.cursor.next;
        next_late = term.cursor.next_late;
      }
    const Margin first = own.margin_at(own.from_, own.late_), last = own.margin_at(next, next_late);
    see({own.from_, next, first.value, last.value, std::max(first.noise, last.noise), first.slope == 0.0});
    own.pass(next, next_late);
  }
}

/// A crossing that rounding puts on the breakpoint itself is left to the slopes there.
bool Clock::cross_before(double end, double end_late, const Margin& margin) {
  const double tau = late_ - margin.value / margin.slope;
  const double sum = from_ + tau;
  if (!(sum < end)) return false;
  if (end < forever) {
    const Margin there = margin_at(end, end_late);
    if (there.value >= -there.noise) return false;
  }
  late_ = rounding_of_sum(from_, tau);
  from_ = sum;
  inside_ = true;
  next_ = {from_, late_, true, false};
  return true;
}

}  // namespace pwlsim::model
