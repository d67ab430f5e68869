/// PartRun: exact segments in place of steps, from where the search for one ends (part_run_search.cpp) to what ends it.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/arithmetic.hpp"
#include "engine/sparse/jumps.hpp"
#include "engine/sparse/part_run.hpp"
#include "engine/sparse/tolerances.hpp"
#include "linalg/legendre.hpp"

namespace pwlsim::engine::sparse {

namespace {

constexpr std::size_t last_coefficients = 3;
constexpr double residual_left = 0.5;

}  // namespace

/// What is not small, of sources and start values; of 1 V where nothing moves at all.
void PartRun::note_least_voltage() {
  const double most = std::max(largest(states_), source_scale_);
  const double least = tolerance::least_scale * (most > 0.0 ? most : 1.0);
  segment_->note_least_voltage(least);
  ties_->note_voltage(least);
  if (forecast_) forecast_->note_voltage(least);
  certificate_.allow_rounding(least);
}

bool PartRun::begin_segment() {
  const double time = point_.time;
  if (limit_) point_.z.assign(limit_->xi.begin(), limit_->xi.end());
  limit_.reset();
  Instant instant = begin_instant();
  for (const Gate& gate : gates_)
    if (!position_ahead_.empty()) position_ahead_[gate.port()] = point_.on[gate.port()];
  if (!starting_) descriptor_.measure_states(point_.z.data(), states_);
  const Beginning beginning{point_.on, instant};
  const std::vector<double> states = states_, z = point_.z, memory = start_memory_;
  const int passed = passing_;
  ties_->note_input_terms(segment_->input_terms());
  segment_->note_passing(passing_, passage_doubt_);
  segment_->note_instant(time, position_before_, z);
  const bool is_found = find_segment(beginning, instant);
  segment_->note_passing(passing_ = -1, 0.0);
  if (!is_found) return false;
  segment_->accept();
  segment_->note_jump(0.0);
  segment_->set_signals(signals_);
  if (open_signals_ && !stops_before_end_)  // of a lap nobody asks
    open_signals_->note(point_.on, segment_->idle_ports(), segment_->free_ports(), 1.0 / segment_->step_length());
  segment_tau_ = 0.0;
  Point next = point_of_segment(0.0, time, certificate_.looks_next());
  instant.jump |= moves(states, z, next.z);
  instant.mode_change |= segment_->changes_visibly(position_before_);
  if (time == 0.0 && instant.jump) note_start_jumps(states, next.z);
  if (instant.jump && request_.jumps && jump_details_.size() < most_jumps_kept && !jump_steps_.first.z.empty()) {
    std::vector<double> after;
    descriptor_.measure_states(next.z.data(), after);
    const double h = jump_steps_.first.time - time;
    jump_details_.push_back(
        describe_jump(part_, {time, states, after}, {h, jump_steps_.first, jump_steps_.second}, tolerance::told_impulse));
  }
  if (instant.jump && request_.probes.sink != nullptr) note_segment_impulses();
  certificate_.add_estimate(segment_->worst_estimate());
  error_holds_ = error_holds_ && !instant.jump;
  if (request_.jumps && !instant.jump) error_ += segment_->start_error(point_.z, next.z);
  if (records_) record_begin(next);
  settle_in(next);
  const bool is_port = passed >= 0 && passed < descriptor_.first_switch();
  segment_start_ = {point_.on, std::move(next.z), start_memory_, is_port && !instant.jump ? passed : -1, {}, false};
  const bool has_one_position = jumps_taken_.empty() || (jumps_taken_.size() == 1 && jumps_taken_.front() == point_.on);
  if (starting_ && request_.use_initial_conditions && has_one_position) {  // what is fast there may have been taken for a jump
    segment_start_.z = z;
    segment_start_.memory = memory;
    segment_start_.is_given = true;
  }
  finish_instant(instant);
  watch_accumulation(beginning, instant, passed);
  const bool goes_on = watch_crowd(time);
  position_before_.clear();
  return goes_on;
}

void PartRun::finish_instant(const Instant& instant) {
  start_memory_.clear();
  if (instant.time > 0.0 && instant.happened()) {
    ++events_;
    jumps_ += instant.jump ? 1 : 0;
    instant_ = instant;
  }
  if (instant.time == 0.0) start_projected_ = instant.jump;
  starting_ = false;
}

/// As ExactRun::watch_accumulation: in a passive part no events accumulate ahead, and what sources or switches do infinitely often has no limit.
void PartRun::watch_accumulation(const Beginning& beginning, const Instant& instant, int passed) {
  if (passive_ || records_ != nullptr || instant.time == 0.0) return;
  if (passed < 0 && !instant.happened()) return;  // the segment before could go no farther
  const auto switches = descriptor_.first_switch();
  const bool is_own = passed >= 0 && passed < switches && !beginning.instant.source_edge && !beginning.instant.mode_change &&
                      std::equal(point_.on.begin() + switches, point_.on.end(), position_before_.begin() + switches);
  if (!is_own) return accumulation_.reset();
  accumulation_.note(instant.time, std::hash<std::string_view>()({point_.on.data(), point_.on.size()}), point_.z.data(), descriptor_.size(),
                     passage_doubt_);
  const auto limit = accumulation_.limit();
  if (!limit || !may_go_to(*limit)) return;
  std::vector<std::string> names;
  for (const DescriptorPort& port : descriptor_.ports())
    if (names.empty() || names.back() != port.name) names.push_back(port.name);
  limit_remarks_.push_back(accumulation_.remark(*limit, names, tolerance_));
  limit_ = limit;
  accumulation_.reset();
}

/// Whether nothing else happens before it: no row, no edge of a source or gate; the segment at hand reaches it.
bool PartRun::may_go_to(const AccumulationWatch::Limit& limit) const {
  if (!limit.is_near(point_.time) || limit.time >= std::min(next_break(), request_.stop)) return false;
  if (limit.time - segment_->start() > segment_->length()) return false;
  const RowGrid& grid = request_.grid;
  std::uint64_t first = 0, last = grid.rows;  // the first row behind the event
  while (first < last) {
    const std::uint64_t middle = first + (last - first) / 2;
    if (grid.time(middle) > point_.time + tolerance_)
      last = middle;
    else
      first = middle + 1;
  }
  return first == grid.rows || !(grid.time(first) < limit.time - tolerance_);
}

/// The segment at hand goes on past the events that are left, as what they change of the states until then is nothing.
void PartRun::go_to_limit() {
  Point next = point_of_segment(limit_->time - segment_->start(), limit_->time, false);
  settle_in(next);
  segment_tau_ = limit_->time - segment_->start();
  restart_due_ = true;
  position_before_ = point_.on;
  last_guard_ = passing_ = -1;
}

std::vector<std::string> PartRun::open_signals() const {
  std::vector<std::string> names;
  if (open_signals_)
    for (const std::size_t number : open_signals_->find(signals_)) names.push_back(part_.island.network.signals[number].name);
  return names;
}

/// Whether a row at that time shows what the segment begins with.
bool PartRun::begins_at(double time) const { return time - segment_->start() <= tolerance_; }

/// What a decay makes of the rounding of states in a signal, per √energy.
double PartRun::largest_share(const Form& signal, const std::vector<std::vector<double>>& decays) {
  double most = 0.0;
  for (const std::vector<double>& decay : decays) most = std::max(most, std::abs(Form::sum(signal.z, decay.data())));
  return most;
}

/// The signals right after the instant, before anything decays; those of the segment, where that cannot be known or is the same.
const std::vector<double>& PartRun::signals_at_start() {
  std::vector<double>& values = segment_start_.signals;
  if (!values.empty() || signals_.empty()) return values;
  const double time = segment_->start();
  std::vector<double> zeta, w;
  sources_.states(time, zeta);
  sources_.evaluate(time, w);
  if (!start_unknowns_) start_unknowns_ = std::make_unique<StartUnknowns>(descriptor_, sources_, request_.stop);
  const KrylovSpace::Origin origin{segment_start_.z, segment_start_.memory, zeta, segment_start_.passed};
  const auto found = start_unknowns_->find({time, segment_start_.on, origin, segment_->size(), segment_->step_length()});
  const std::vector<double> y = segment_->at(0.0);
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    values.push_back(Form::sum(signals_[i].w, w.data(), segment_->signal(i, y)));
    if (!found) continue;
    const double start = signals_[i].value(found->z.data(), w.data());
    const double size = std::max({signal_scale_[i], std::abs(start), std::abs(values[i])});
    const double step = std::abs(start - values[i]);
    // A peak beyond all that the signal has had is believed only where it is far from what rounding of the states makes across a leak.
    const bool is_peak = !segment_start_.is_given && step > std::max(signal_scale_[i], std::abs(values[i]));
    const double share = is_peak ? largest_share(signals_[i], found->decays) : 0.0;
    const double noise = tolerance::same_jump * segment_->size() * share;
    if (step > std::max(tolerance::known_digits * size, noise)) values[i] = start;  // else what rows behind it go on from
  }
  return values;
}

/// With its rates where the certificate, or a record, looks at them.
Point PartRun::point_of_segment(double tau, double time, bool has_rates) {
  Point point;
  point.on = point_.on;
  point.time = time;
  const std::vector<double>& y = segment_->at(tau);
  segment_->unknowns(y, point.z);
  if (has_rates) segment_->rates(y, point.k, point.k_sizes);
  sources_.evaluate(time, point.w);
  return point;
}

bool PartRun::is_same_instant(double a, double b) const { return std::abs(a - b) <= break_tolerance_; }

/// To the next passage, the next known instant, or as far as the segment reaches; with probes no farther than they are polynomials.
bool PartRun::follow_segment() {
  if (limit_) {
    go_to_limit();
    return true;
  }
  const double limit = std::min(next_break(), request_.stop);
  const ExactSegment::Passage& passage = segment_->locate(limit - segment_->start());
  const double tau = request_.probes.sink != nullptr ? resolved_until(passage.tau) : passage.tau;
  const SegmentTimes times{segment_->length(), passage.tau};
  if (segment_tau_ == 0.0) certify_within(point_, 0.0, times);
  const auto certify = [&](const Point& point, double at) {
    if (tau < passage.tau)
      certify_within(point, at, times);
    else
      certificate_.add_point(point, ports_, times, ports_at_zero(at));
  };
  for (const double share : inner_points) {
    if (!certificate_.wants_point()) continue;
    const double inside = segment_tau_ + share * (tau - segment_tau_);
    certify(point_of_segment(inside, segment_->start() + inside, true), inside);
  }
  watch_inside(tau);
  const double time = segment_->start() + tau;
  const bool has_rates = certificate_.looks_next() || records_ != nullptr;
  Point next = point_of_segment(tau, is_same_instant(time, limit) ? limit : time, has_rates);
  certify(next, tau);
  if (records_ && tau >= passage.tau) record_end(next, tau, passage);
  settle_in(next);
  segment_tau_ = tau;
  if (tau < passage.tau) return true;
  if (request_.jumps) add_error(tau);
  pass(passage);
  return true;
}

/// Where rates at a point of the segment are in doubt, they are so for as long as what decays fast: as long as half of the residual is left.
void PartRun::certify_within(const Point& point, double tau, const SegmentTimes& times) {
  const std::vector<int> at_zero = ports_at_zero(tau);
  SegmentTimes lasting{times.length, times.followed - tau};
  const double shortest = tolerance::shortest_segment * request_.stop;
  const double doubt = certificate_.looks_next() ? certificate_.row_residual(point, times) : 0.0;
  if (doubt > tolerance::doubtful_rows) {
    double residual = 0.0;
    while (!(residual > residual_left * doubt) && lasting.followed > shortest) {
      lasting.followed *= 0.5;
      const double later = tau + lasting.followed;
      const Point inside = point_of_segment(later, segment_->start() + later, true);
      certificate_.add_point(inside, ports_, lasting, at_zero);
      residual = certificate_.row_residual(inside, times);
    }
  }
  certificate_.add_point(point, ports_, lasting, at_zero);
}

/// Of the next point, if the certificate looks at it.
std::vector<int> PartRun::ports_at_zero(double tau) {
  std::vector<int> at_zero;
  if (!certificate_.looks_next()) return at_zero;
  const std::vector<double> y = segment_->at(tau);
  for (int i = 0; i < descriptor_.first_switch(); ++i)
    if (segment_->is_at_zero(i, y)) at_zero.push_back(i);
  return at_zero;
}

/// Of the segment up to there. Errors of passive parts do not grow by themselves: those of segments add up.
void PartRun::add_error(double tau) {
  const ErrorGrowth growth = segment_->error_growth(tau);
  error_ += growth.error + growth.rounding;
  error_holds_ = error_holds_ && growth.holds;
}

void PartRun::record_begin(const Point& first) {
  SegmentRecord& record = records_->emplace_back();
  record.jumps = jumps_taken_;
  record.on = point_.on;
  record.shift = 1.0 / segment_->step_length();
  record.refines = segment_->is_refined();
  record.begin = segment_->start();
  record.rates_at_begin = rates_at(first);
  record.size = segment_->size();
  if (records_->size() == 1) record.unknowns_at_begin = first.z;
  for (const sparse::State& state : descriptor_.states()) record.stores_at_begin.push_back(state.value(first.z.data()));
}

/// E z' as the equations have it: an error of z makes one in what is fast there, which decays. The rounding of z' in what decays fast is in all of E z'.
std::vector<double> PartRun::rates_at(const Point& point) const {
  std::vector<double> rates(point.z.size());
  descriptor_.rates(point.z.data(), point.w.data(), rates.data());
  const std::vector<char> is_differential = descriptor_.differential_rows();
  for (std::size_t i = 0; i < rates.size(); ++i)
    if (is_differential[i] == 0) rates[i] = 0.0;
  return rates;
}

void PartRun::record_end(const Point& last, double tau, const ExactSegment::Passage& passage) {
  SegmentRecord& record = records_->back();
  record.length = tau;
  record.rates_at_end = last.k;
  const bool is_known = is_same_instant(last.time, std::min(next_break(), request_.stop));
  record.ends_unknown = !is_known && (!passage.found || passage.guard < 0);
  if (!passage.found || passage.guard < 0) return;
  const std::vector<double> y = segment_->at(tau);
  record.guards.push_back(falling(passage.guard, segment_->guard_rate(passage.guard, y)));
  for (const int guard : segment_->falling_guards(y))
    if (guard != passage.guard) record.guards.push_back(falling(guard, segment_->guard_rate(guard, y)));
}

/// The guard of a port in its position, or of a control.
FallingGuard PartRun::falling(int guard, double rate) const {
  const auto number = static_cast<std::size_t>(guard), ports = static_cast<std::size_t>(descriptor_.first_switch());
  if (number >= ports) {
    const WatchedControl& control = controls_[number - ports];
    FallingGuard falling{{control.value.z, {}, 0.0}, rate, control.port};
    if (!control.holds(point_.on))
      for (Form::IndexedTerm& part : falling.form.z) part.coefficient = -part.coefficient;
    return falling;
  }
  const DescriptorPort& port = descriptor_.ports()[number];
  if (point_.on[number] != 0) return {{{{port.row, 1.0}}, {}, 0.0}, rate, number};
  return {{port.slack.z, {}, 0.0}, rate, number};
}

void PartRun::pass(const ExactSegment::Passage& passage) {
  restart_due_ = point_.time < request_.stop - tolerance_;
  passage_doubt_ = 0.0;
  if (!passage.found) {
    if (point_.time < std::min(next_break(), request_.stop)) segment_->note_end(passage.tau);
    return;
  }
  const bool is_idle = passage.tau <= tolerance::no_time * request_.stop;
  if (!is_idle) segment_->unmute();
  if (is_idle && last_guard_ == passage.guard && passage.guard >= 0) segment_->mute(passage.guard);
  if (is_idle && last_guard_ == passage.guard && passage.guard < 0) segment_->sample_start();
  if (!is_idle) segment_->note_event(passage.tau);
  last_guard_ = passing_ = passage.guard;
  position_before_ = position_ahead_ = point_.on;
  if (passage.guard < 0) return;
  const auto guard = static_cast<std::size_t>(passage.guard), ports = static_cast<std::size_t>(descriptor_.first_switch());
  const std::vector<double> y = segment_->at(passage.tau), slope = segment_->slope(y);
  for (std::size_t i = 0; i < controls_.size(); ++i) {
    const bool passes_with = guard >= ports && controls_[i].passes_with(controls_[guard - ports], point_.on);
    if (passes_with || passes_too(i, y, slope)) position_ahead_[controls_[i].port] ^= 1;
  }
  if (guard < ports) {
    passage_doubt_ = segment_->time_doubt(passage.guard, y);
    point_.on[guard] ^= 1;
    position_ahead_[guard] ^= 1;
  }
  descriptor_.hold_blocked(position_ahead_);
}

/// Whether a control that visibly falls passes at the instant of another passage, the state being y there.
bool PartRun::passes_too(std::size_t control, const std::vector<double>& y, const std::vector<double>& slope) const {
  const int guard = descriptor_.first_switch() + static_cast<int>(control);
  const double value = segment_->guard(guard, y), fall = -segment_->guard(guard, slope);
  return std::abs(value) <= fall * break_tolerance_ && fall * request_.stop > controls_[control].noise(value, largest(point_.z));
}

/// Where from segment_tau_ on the probes are polynomials of degree 15, to rounding. In a segment of many pieces the next is sought at the length of the last, and at twice that now and then.
double PartRun::resolved_until(double tau) {
  const bool is_first = segment_tau_ == 0.0, grows = is_first || growing_pieces_.is_due();
  const double longest = is_first ? tau : (grows ? 2.0 : 1.0) * piece_length_;
  double end = std::min(tau, segment_tau_ + longest);
  while (end - segment_tau_ > tolerance::shortest_piece * tau && !is_resolved(segment_tau_, end))
    end = segment_tau_ + 0.5 * (end - segment_tau_);
  if (grows) growing_pieces_.note(is_first || end - segment_tau_ > piece_length_);
  piece_length_ = end - segment_tau_;
  return end;
}

bool PartRun::is_resolved(double from, double to) {
  const auto& point = linalg::gauss_legendre().point;
  std::vector<double> values(signals_.size() * linalg::legendre_points);
  const std::vector<double> begin = segment_->at(from);
  for (std::size_t i = 0; i < linalg::legendre_points; ++i) {
    const std::vector<double>& y = segment_->later(begin, 0.5 * (1.0 + point[i]) * (to - from));
    for (std::size_t k = 0; k < signals_.size(); ++k) values[k * linalg::legendre_points + i] = segment_->signal(k, y);
  }
  for (std::size_t k = 0; k < signals_.size(); ++k) {
    const linalg::LegendreSeries series(&values[k * linalg::legendre_points]);
    const double start = segment_->signal(k, begin);
    double size = std::max(signal_scale_[k], segment_->signal_terms(k, begin)), last = 0.0;
    // A signal that begins far from what drives it is nothing but rounding at first.
    const double noise = tolerance::signal_rounding * signal_size(static_cast<int>(k));
    for (const double c : series.coefficients()) size = std::max(size, std::abs(c));
    for (std::size_t c = 0; c < last_coefficients; ++c)
      last = std::max(last, std::abs(series.coefficients()[linalg::legendre_points - 1 - c]));
    if (std::max(last, std::abs(series(-1.0) - start)) > std::max(tolerance::piece_resolution * size, noise)) return false;
  }
  return true;
}

}  // namespace pwlsim::engine::sparse
