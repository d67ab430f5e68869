#include "engine/sparse/exact_segment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "base/arithmetic.hpp"
#include "engine/sparse/stepper.hpp"
#include "engine/sparse/tolerances.hpp"
#include "linalg/factorisations.hpp"

namespace pwlsim::engine::sparse {

namespace {

/// Vectors at which the error is looked at.
constexpr std::array<int, 22> dimensions{3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30, 32, 34, 36, 38, most_of_segment};
constexpr int least_to_foretell = 8;       ///< below so many vectors a look costs less than a vector
constexpr double share_of_foretold = 0.8;  ///< convergence speeds up
constexpr int most_no_better = 3;          ///< looks at an error that do not lessen it: it is rounding
/// The same above the rounding that vectors mostly have: a motion that S shows first as one of its own, growing, hides what the others gain.
constexpr int most_no_better_early = 6;
constexpr int most_cuts = 12, most_extensions = 6, most_doublings = 3;
constexpr double shorter = 32.0;             ///< a segment that cannot be made is tried again at so small a part
constexpr double most_rise = 1e6;            ///< of them at the start of a segment: beyond, and beyond what the run has had, are impulses
constexpr double most_loss = 1e6;            ///< of vectors by orthogonalisation, in roundings
constexpr double least_share = 1.0 / 256.0;  ///< of the usual length: shorter ones make no space of their own
constexpr double muting = 30.0, most_muted = 1e6;
constexpr double tolerances_of_run = 200.0, most_tolerances = 10.0;  ///< that may add up over the run, and that one segment may have
constexpr double far_below = 1.0 / 8.0;                              ///< of the tolerance: an estimate with which fewer vectors are tried
constexpr int vectors_of_signs = 3;                                  ///< enough for signs that are far from zero
constexpr double share_of_error = 100.0;                             ///< at the start, of which a sign that is clear is no part

/// Vectors at which to look again: the next dimension, or a share of the way to where the last two looks, at before and at now vectors, foretell the tolerance.
int next_dimension(int before, double error_before, int now, double error_now, double wanted) {
  const int next = *std::upper_bound(dimensions.begin(), dimensions.end() - 1, now);
  const double gain = std::log(error_before / error_now) / (now - before);
  if (now < least_to_foretell || !(gain > 0.0) || !(error_now > wanted)) return next;
  const double foretold = now + share_of_foretold * std::log(error_now / wanted) / gain;
  return std::max(next, static_cast<int>(std::min<double>(foretold, dimensions.back())));
}

double largest_error(const std::vector<KrylovSpace::Checkpoint>& points) {
  return std::accumulate(points.begin(), points.end(), 0.0, [](double most, const auto& point) { return std::max(most, point.error); });
}

}  // namespace

ExactSegment::ExactSegment(const Descriptor& descriptor, const Sources& sources, const std::vector<WatchedControl>& controls,
                           double tolerance, double stop)
    : descriptor_(descriptor),
      sources_(sources),
      controls_(controls),
      tolerance_(tolerance),
      stop_(stop),
      space_(descriptor, sources.exosystem(), stop),
      is_passive_(descriptor.passive()) {
  system_.exosystem = std::make_shared<model::Exosystem>(std::vector<model::SourceFunction>{}, false);
  held_.assign(static_cast<std::size_t>(descriptor.first_switch()), 0.0);
  find_parallel_ports();
}

/// Ports across the same two nodes, without resistance or drop.
void ExactSegment::find_parallel_ports() {
  const auto& ports = descriptor_.ports();
  std::map<std::pair<model::NodeIndex, model::NodeIndex>, std::vector<int>> across;
  for (std::size_t i = 0; i < ports.size(); ++i) {
    const Form& slack = ports[i].slack;
    const bool is_ideal =
        slack.constant == 0.0 && slack.w.empty() &&
        std::all_of(slack.z.begin(), slack.z.end(), [&](const Form::IndexedTerm& part) { return part.index < descriptor_.nodes(); });
    if (is_ideal && ports[i].p != ports[i].n) across[std::minmax(ports[i].p, ports[i].n)].push_back(static_cast<int>(i));
  }
  beside_.resize(ports.size());
  for (const auto& [nodes, group] : across)
    for (const int i : group)
      for (const int j : group)
        if (i != j) beside_[static_cast<std::size_t>(i)].push_back(j);
}

void ExactSegment::note_least_voltage(double least) {
  least_voltage_ = least;
  space_.note_least_voltage(least);
  double square = 0.0;
  for (const State& state : descriptor_.states())
    square += std::abs(state.storage) * (state.is_current ? 1.0 / descriptor_.r0() : descriptor_.r0()) * least * least;
  peak_ = square > 0.0 ? std::sqrt(square) : 1.0;  // without states only sources move
}

/// Grows the space until the estimate is within the tolerance over all of length_, or vectors are nothing but rounding and it is not far from that. False:
/// it cannot.
bool ExactSegment::resolve() {
  double before = INFINITY, best = INFINITY;
  int last = 0, best_at = 0, no_better = 0;
  const int most_vectors = most_vectors_now();
  for (int m = std::min(first_dimension(), most_vectors);;) {
    space_.grow(m);
    if (!space_.is_sound()) break;
    const auto& points = space_.estimate(length_);
    estimate_ = largest_error(points);
    present_tolerance_ = tolerance_for(length_);
    if (estimate_ <= present_tolerance_ * size_) return true;
    const bool is_at_end = space_.is_full() && !(estimate_ > tolerance::plain_rounding * size_ && space_.goes_on());
    if (is_at_end && estimate_ <= std::min(best, tolerance::converged_rounding * size_)) return true;
    if (is_at_end) break;
    no_better = estimate_ < best ? 0 : no_better + 1;
    if (no_better == 0) {
      best = estimate_;
      best_at = space_.dimension();
    }
    const int most = best <= tolerance::plain_rounding * size_ ? most_no_better : most_no_better_early;
    if (no_better >= most && best <= tolerance::converged_rounding * size_) break;
    const int next = next_dimension(last, before, m, estimate_, present_tolerance_ * size_);
    before = estimate_;
    last = m;
    if (m >= most_vectors) {
      note_all_decays();
      return is_cut_within(points);
    }
    m = std::min(next, most_vectors);
  }
  const bool is_near = best_at > 0 && best <= tolerance::converged_rounding * size_;
  if (!is_near && !space_.is_sound() && last > 0) space_.shrink(last);  // it shows what turns
  if (!is_near) return false;
  space_.shrink(best_at);
  estimate_ = best;
  if (space_.is_sound()) (void)space_.estimate(length_);
  return space_.is_sound();
}

/// Where the error is looked at last: as many as had digits in the position, and now and then one look more.
int ExactSegment::most_vectors_now() {
  Habit& habit = habits_[key_];
  if (habit.most_vectors == dimensions.back() || !habit.more_vectors.is_due()) return habit.most_vectors;
  return *std::upper_bound(dimensions.begin(), dimensions.end() - 1, habit.most_vectors);
}

/// As many as the position took before, or else each of the last two segments, where those are more than a look costs.
int ExactSegment::first_dimension() const {
  const auto habit = habits_.find(key_);
  const int known = habit != habits_.end() ? habit->second.vectors : 0;
  const int expected = known > 0 ? known : std::min(vectors_of_last_, vectors_of_one_before_);
  return expected >= least_to_foretell ? expected : dimensions.front();
}

/// Vectors that are to be expected where so many gave the present estimate: fewer where that is far below the tolerance.
int ExactSegment::expected_vectors() const {
  const int m = space_.dimension();
  if (!(estimate_ < far_below * present_tolerance_ * size_)) return m;
  const auto* const at = std::lower_bound(dimensions.begin(), dimensions.end(), m);
  return at != dimensions.begin() ? *(at - 1) : dimensions.front();
}

/// Errors of segments add up: those that are much of the run, of which it has few, may have more where vectors are many.
double ExactSegment::tolerance_for(double length) const {
  if (keeps_tolerance_ || space_.dimension() < many_vectors) return tolerance_;
  return std::clamp(tolerances_of_run * length / stop_, 1.0, most_tolerances) * tolerance_;
}

/// Whether few vectors show ports far on the wrong side right after the start, where their error is what the next vector shows of a port: a voltage that a constraint of currents decides
/// may be wrong by far more than states are. Those that are visibly on the wrong side then fall.
bool ExactSegment::has_wrong_signs() {
  space_.grow(vectors_of_signs);
  if (!space_.is_sound()) return false;
  std::vector<double> z, w;
  space_.unknowns(space_.first().data(), z);
  sources_.evaluate(start_, w);
  const std::vector<double> next = space_.next_unknowns();
  const auto& ports = descriptor_.ports();
  const auto count = static_cast<std::size_t>(descriptor_.first_switch());
  double input = least_voltage_;
  for (std::size_t i = 0; i < count; ++i) input = std::max(input, std::abs(z[static_cast<std::size_t>(ports[i].row)]));
  const double error = share_of_error * space_.error_at_start(), margin = std::max(tolerance::clear_sign, error / size_);
  negative_.clear();
  bool is_clear = false;
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_on = on_[i] != 0;
    const double value = ports[i].free_variable(is_on, z.data(), w.data());
    if (value >= 0.0 || ports[i].blocks(on_)) continue;
    const double size = is_on ? input : std::max(least_voltage_, ports[i].slack_size(z.data(), w.data()));
    is_clear |= value < -std::max(margin * size, error * std::abs(ports[i].response(is_on, next.data())));
    if (value < -tolerance::clear_sign * size) negative_.push_back(static_cast<int>(i));
  }
  return is_clear;
}

/// The part of length_ whose error is within the tolerance. False: there is none.
bool ExactSegment::is_cut_within(const std::vector<KrylovSpace::Checkpoint>& points) {
  length_ = estimate_ = 0.0;
  for (const auto& point : points) {
    if (!(point.error <= present_tolerance_ * size_)) break;
    length_ = point.tau;
    estimate_ = std::max(estimate_, point.error);
  }
  if (length_ > 0.0) (void)space_.estimate(length_);  // for its reach
  return length_ > 0.0;
}

/// It may serve for longer than it was made for.
void ExactSegment::stretch(double longest) {
  if (!space_.is_full() || !(length_ < longest) || !reaches(longest))
    for (int doubled = 0; doubled < most_doublings && length_ < longest && reaches(std::min(2.0 * length_, longest));) ++doubled;
  if (length_ < longest) (void)space_.estimate(length_);  // for its reach
}

/// Whether the segment may be so long: it is, then.
bool ExactSegment::reaches(double longer) {
  const auto& points = space_.estimate(longer);
  const double most = largest_error(points);
  if (!(most <= tolerance_for(longer) * size_) || !(points.back().rounding <= tolerance::lengthened_rounding * size_) || !has_digits() ||
      shows_growth(longer))
    return false;
  estimate_ = most;
  length_ = longer;
  present_tolerance_ = tolerance_for(longer);
  return true;
}

/// Whether voltages and currents, over the length last estimated, are more than what rounding leaves of sums of vectors. In currents that a constraint of voltages
/// decides, as that of a wire across an inductor, each vector multiplies the rounding of the one before by 1/h, h the size of its new part.
bool ExactSegment::has_digits() {
  const auto is_known = [&](double terms, double before, double most, double after) {  // after a jump: with its impulses
    const double size = std::max(before, least_voltage_);
    return tolerance::row_rounding * terms <= tolerance::known_digits * std::clamp(after, size, std::max(most, most_rise * size));
  };
  const KrylovSpace::Sizes terms = space_.largest_terms(), first = space_.largest_first();
  return is_known(terms.voltage, voltage_, most_voltage_, first.voltage) && is_known(terms.other, current_, most_current_, first.other);
}

/// Begins the space for the signs alone. True: these are wrong. `is_begun`: the space is as good as any.
bool ExactSegment::is_wrong_by_signs(Factors& factors, double shift, const Origin& start, bool& is_begun) {
  const Factor* factor = factors.at(shift, start.on);
  if (!factor || has_lost_rank(*factor)) return false;
  space_.begin_roughly(passing_ < 0);
  const auto begun = space_.begin(*factor, shift, start.on, {start.z, start.more, zeta_}, peak_);
  space_.begin_roughly(false);
  if (begun != KrylovSpace::Begun::yes || !std::isfinite(space_.start_size())) return false;
  size_ = std::max(peak_, space_.start_size());
  is_begun = space_.is_refined();
  return has_wrong_signs();
}

/// By what they have been so far, z included.
void ExactSegment::count_states(const std::vector<double>& z) {
  if (scale_ == nullptr) return;
  std::vector<double> sizes(descriptor_.states().size());
  for (std::size_t i = 0; i < sizes.size(); ++i) sizes[i] = scale_->size(i, z);
  space_.count_by(std::move(sizes));
}

/// At lengths that become shorter. Where the usual one is no more than what an event left, so that the vectors of shorter ones are rounding, longer ones serve.
ExactSegment::Opened ExactSegment::build(Factors& factors, const Origin& start) {
  const double length = std::max(usual_length(start.on, start.longest), least_share * usual_length(start.on, stop_));
  expected_ = std::min(length, start.longest);
  count_states(start.z);
  space_.refine_all(refines_ || habits_[key_].refines);
  const Opened opened = build(factors, start, length, 1.0 / shorter, most_cuts);
  if (opened != Opened::unresolved || !(shorter * length <= start.longest)) return opened;
  return build(factors, start, shorter * length, shorter, most_extensions);
}

/// `ratio`: of a length that fails, the next.
ExactSegment::Opened ExactSegment::build(Factors& factors, const Origin& start, double length, double ratio, int attempts) {
  for (int tried = 0; tried < attempts && length > tolerance::shortest_segment * stop_ && !(length > stop_); ++tried) {
    const double shift = shift_for(length);
    bool is_begun = false;
    is_rejected_ = rejects_early_ && is_wrong_by_signs(factors, shift, start, is_begun);
    if (is_rejected_) return Opened::yes;
    if (!is_begun) {
      const Factor* factor = factors.at(shift, start.on);
      if (!factor) return Opened::singular;
      if (has_lost_rank(*factor)) return Opened::unresolved;
      if (space_.begin(*factor, shift, start.on, {start.z, start.more, zeta_}, peak_) != KrylovSpace::Begun::yes)
        return Opened::contradicted;
    }
    if (!std::isfinite(space_.start_size())) return Opened::unresolved;
    size_ = std::max(peak_, space_.start_size());
    length_ = length;
    present_tolerance_ = tolerance_;
    const bool is_resolved = resolve();
    const bool is_cut = !is_resolved || length_ < length;
    if ((forgets_turning() || turns_by_more(is_cut) || (is_cut && takes_shorter_turn())) && shift_for(length) != shift) continue;
    const bool has_all = is_resolved && leaves_out_growth() && keeps_digits();
    if (is_resolved && !has_all && takes_longer_turn() && shift_for(length) != shift) continue;
    if (has_all && space_.dimension() > habits_[key_].most_vectors) note_digits(space_.dimension(), true);
    if (has_all || (is_resolved && takes_back(length))) {
      if (length_ >= length) stretch(start.longest);
      note_attempt(length_, true);
      return Opened::yes;
    }
    if (shift_for(length) != shift || takes_own_shift(length, shift)) continue;  // it may have learnt of decays of all rates
    note_attempt(length, false);
    length *= ratio;
  }
  return Opened::unresolved;
}

/// In a passive network nothing grows: what does in the space is rounding in its last vectors, and would grow until it is seen.
bool ExactSegment::shows_growth(double length) { return is_passive_ && space_.grows(length); }

/// With fewer vectors. False: the error is not within the tolerance then.
bool ExactSegment::leaves_out_growth() {
  while (shows_growth(length_)) {
    if (space_.dimension() <= 1) return false;
    space_.shrink(space_.dimension() - 1);
    if (!space_.is_sound()) return false;
    estimate_ = largest_error(space_.estimate(length_));
    if (!(estimate_ <= tolerance::converged_rounding * size_)) return false;
  }
  return true;
}

bool ExactSegment::keeps_digits() { return space_.loss() <= most_loss && has_digits(); }

/// What a constraint decides has a rounding that grows with each vector, however long the segment: one of fewer vectors is shorter, and has digits. False: it is no longer than one that is made anew.
bool ExactSegment::takes_back(double length) {
  const auto* at = std::lower_bound(dimensions.begin(), dimensions.end(), space_.dimension());
  while (at != dimensions.begin() && *(at - 1) >= many_vectors) {
    space_.shrink(*--at);
    if (!space_.is_sound()) continue;
    if (!is_cut_within(space_.estimate(length)) || length_ <= length / shorter) return false;
    if (!keeps_digits()) continue;
    note_digits(*at, false);
    return true;
  }
  return false;
}

/// Whether the position is singular at a step only because that is so short that rounding hides what its ports move in it: what it holds at zero by ε would then not be held.
bool ExactSegment::has_lost_rank(const Factor& factor) {
  bool& is_regular = habits_[key_].is_regular;
  is_regular |= !factor.closing();
  return is_regular && factor.closing();
}

double ExactSegment::step(Factors& factors, const Origin& start, std::vector<double>& z) {
  key_ = key(start.on);
  sources_.states(start.time, zeta_);
  const double shift = shift_for(usual_length(start.on, start.longest));
  const Factor* factor = factors.at(shift, start.on);
  if (!factor || space_.begin(*factor, shift, start.on, {start.z, start.more, zeta_}, peak_) != KrylovSpace::Begun::yes) return 0.0;
  if (!(space_.start_rounding() <= tolerance::start_rounding * std::max(peak_, space_.start_size()))) return 0.0;
  z = space_.first_unknowns();
  return 1.0 / shift;
}

bool ExactSegment::take_back(double h, std::vector<double>& z) {
  const linalg::Matrix& a = space_.flow().a();
  const double rounding = tolerance::row_rounding * space_.loss() * h * a.norm() * size_;
  if (!(h * space_.defect_at_start() + rounding <= tolerance::converged_rounding * size_)) return false;
  const linalg::Vector y = space_.first() - h * (a * space_.first());
  space_.unknowns(y.data(), z);
  return true;
}

std::vector<double> ExactSegment::euler_end(double h) const {
  const linalg::Matrix& a = space_.flow().a();
  const linalg::Vector y = Eigen::PartialPivLU<linalg::Matrix>(linalg::Matrix::Identity(a.rows(), a.cols()) - h * a).solve(space_.first());
  std::vector<double> z;
  space_.unknowns(y.data(), z);
  return z;
}

ExactSegment::Opened ExactSegment::open(Factors& factors, const Origin& start, int again) {
  is_rejected_ = false;
  start_ = start.time;
  on_ = start.on;
  voltage_ = largest(std::span(start.z).first(static_cast<std::size_t>(descriptor_.nodes())));
  current_ = largest(std::span(start.z).subspan(static_cast<std::size_t>(descriptor_.nodes())));
  most_voltage_ = std::max(most_voltage_, voltage_);
  most_current_ = std::max(most_current_, current_);
  key_ = key(start.on);
  sources_.states(start.time, zeta_);
  if (start.stepped > 0.0) {
    const linalg::Vector zeta = Eigen::Map<const linalg::Vector>(zeta_.data(), static_cast<Eigen::Index>(zeta_.size()));
    const linalg::Vector after = after_step(sources_.exosystem(), start.stepped, zeta);
    zeta_.assign(after.begin(), after.end());
  }
  const Opened opened = build(factors, start);
  if (opened != Opened::yes || is_rejected_) return opened;
  start_rounding_ = space_.rounding_at_start();
  if (!(start_rounding_ <= tolerance::start_rounding * size_)) return Opened::unresolved;
  ++segments_;
  Habit& habit = habits_[key_];
  habit.vectors = expected_vectors();
  if (habit.vectors < habit.most_vectors)  // as many as there may be say nothing of other positions
    vectors_of_one_before_ = std::exchange(vectors_of_last_, habit.vectors);
  located_ = false;
  watch_guards(start.on);
  vectors_ += static_cast<std::uint64_t>(space_.dimension());
  if (again < (hides_sign_ ? 2 : 1) && ends_with_decay()) return open(factors, start, again + 1);
  judge_start();
  note_later_rounding();
  if (again > 0 || !is_undecided_by_habit(start.longest)) return Opened::yes;
  habits_[key_].length = 0.0;
  return open(factors, start, again + 1);
}

/// With as many vectors as a decay asks for that a guard behind a leak reads.
void ExactSegment::watch_guards(const Position& on) {
  for (;;) {
    take_guards(on);
    bound_guards();
    const int before = space_.dimension();
    if (hidden_decay_ == 0.0 || space_.is_full() || before >= dimensions.back()) return;
    space_.grow(*std::upper_bound(dimensions.begin(), dimensions.end() - 1, before));
    const bool is_better =
        space_.is_sound() && largest_error(space_.estimate(length_)) <= estimate_ && keeps_digits() && !shows_growth(length_);
    if (!is_better) space_.shrink(before);
    estimate_ = largest_error(space_.estimate(length_));
  }
}

const std::vector<double>& ExactSegment::later(const std::vector<double>& y, double length) {
  y_.assign(y.begin(), y.end());
  work_.resize(2 * y_.size());
  space_.flow().apply_once(length, y_.data(), work_.data());
  return y_;
}

std::vector<double> ExactSegment::slope(const std::vector<double>& y) const {
  std::vector<double> slope(y.size());
  linalg::multiply(space_.flow().a(), y.data(), slope.data());
  return slope;
}

double ExactSegment::guard_rate(int guard, const std::vector<double>& y) const {
  const Eigen::Map<const linalg::Vector> at(y.data(), static_cast<Eigen::Index>(y.size()));
  return mode_->guards.row(guard).dot(space_.flow().a() * at);
}

std::vector<int> ExactSegment::falling_guards(const std::vector<double>& y) const {
  std::vector<int> guards;
  for (const int row : segment_.rows) {
    if (row >= descriptor_.first_switch()) continue;
    const double value = linalg::row_times(mode_->guards, row, y.data());
    if (std::abs(value) <= tolerance::guard_at_zero * mode_->absolute_guards.row(row).dot(space_.reach()) && guard_rate(row, y) < 0.0)
      guards.push_back(row);
  }
  return guards;
}

void ExactSegment::set_signals(const std::vector<Form>& signals) {
  signal_rows_.resize(static_cast<Eigen::Index>(signals.size()), space_.dimension());
  signal_constants_.resize(signals.size());
  for (std::size_t i = 0; i < signals.size(); ++i) {
    signal_rows_.row(static_cast<Eigen::Index>(i)) = space_.row_of_unknowns(signals[i]).transpose();
    signal_constants_[i] = signals[i].constant;
  }
}

double ExactSegment::signal(std::size_t i, const std::vector<double>& y) const {
  return signal_constants_[i] + linalg::row_times(signal_rows_, static_cast<Eigen::Index>(i), y.data());
}

double ExactSegment::signal_terms(std::size_t i, const std::vector<double>& y) const {
  return std::abs(signal_constants_[i]) + linalg::absolute_row_times(signal_rows_, static_cast<Eigen::Index>(i), y.data());
}

ErrorGrowth ExactSegment::error_growth(double tau) const {
  const SourceDirections directions(sources_.exosystem(),
                                    Eigen::Map<const linalg::Vector>(zeta_.data(), static_cast<Eigen::Index>(zeta_.size())));
  ErrorGrowth growth = sparse::error_growth(space_.relation(), directions, tau, tolerance::solution_rounding * size_);
  growth.error *= space_.coupling();
  growth.rounding = space_.coupling() * (start_rounding_ + growth.rounding);
  return growth;
}

void ExactSegment::accept() {
  peak_ = size_;
  worst_ = std::max(worst_, relative_error());
}

void ExactSegment::mute(int guard) {
  double& factor = muted_.try_emplace(guard, 1.0).first->second;
  factor = std::min(muting * factor, most_muted);
}

}  // namespace pwlsim::engine::sparse
