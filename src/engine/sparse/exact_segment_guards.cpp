/// ExactSegment: its guards, their rounding, and their signs at the start.
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/arithmetic.hpp"
#include "engine/sparse/exact_segment.hpp"
#include "engine/sparse/tolerances.hpp"
#include "linalg/balance.hpp"
#include "linalg/fast_decays.hpp"

namespace pwlsim::engine::sparse {

namespace {

constexpr double noise_in_doubt = 100.0;  ///< tolerances of a segment, at most, where the time of a passage is in doubt
constexpr double beyond_size = 2e2;       ///< times what a guard is measured against, its noise by the norms of row and state hides it
constexpr double time_constants_of_decay = 40.0;  ///< until it is over, to rounding
constexpr double most_of_length_for_decay = 0.1;  ///< it is worth a segment of its own
constexpr double beyond_held = 2.0;               ///< of a slack that was held at zero: what is no rounding of it

}  // namespace

/// Rows: u or slack of each port that is no switch, then the margin of each control.
void ExactSegment::take_guards(const Position& on) {
  mode_ = std::make_unique<model::Mode>();
  const auto ports = static_cast<std::size_t>(descriptor_.first_switch());
  std::vector<KrylovSpace::Reading> values(ports + controls_.size());
  segment_.rows.clear();
  for (std::size_t i = 0; i < ports; ++i) {
    const DescriptorPort& port = descriptor_.ports()[i];
    if (port.blocks(on)) continue;
    if (on[i] != 0)
      values[i].unknown = port.row;
    else
      values[i].form = &port.slack;
    segment_.rows.push_back(static_cast<int>(i));
  }
  for (std::size_t i = 0; i < controls_.size(); ++i) {
    const WatchedControl& control = controls_[i];
    const bool holds = control.holds(on);
    values[ports + i] = {&control.value, -1, holds ? 1.0 : -1.0, holds ? -control.off_level : control.on_level};
  }
  mode_->guards = space_.rows(values);
  drop_empty_guards();
  for (std::size_t i = 0; i < controls_.size(); ++i) segment_.rows.push_back(static_cast<int>(ports + i));
}

/// Whether a port is off beside one that is on without resistance or drop.
bool ExactSegment::is_short_circuited(int row) const {
  if (row >= descriptor_.first_switch() || on_[static_cast<std::size_t>(row)] != 0) return false;
  const auto& beside = beside_[static_cast<std::size_t>(row)];
  return std::any_of(beside.begin(), beside.end(), [&](int port) { return on_[static_cast<std::size_t>(port)] != 0; });
}

/// What resistors carry that alone meet the input, and by the digits that elimination may lose more. Infinite: others meet it, too.
double ExactSegment::size_by_leaks(std::size_t port) const {
  return tolerance::lost_terms * std::max(voltage_, least_voltage_) * descriptor_.leaks_at(port, on_);
}

/// A port at zero on both sides for good, as a diode beside a closed switch: its row is rounding.
void ExactSegment::drop_empty_guards() {
  if (segment_.rows.empty()) return;
  node_terms_ = space_.largest_terms().voltage;
  input_terms_ = space_.largest_terms(descriptor_.ports().front().row, static_cast<int>(descriptor_.ports().size()));
  const auto reach = [&](int row) { return mode_->guards.row(row).cwiseAbs().dot(space_.reach()); };
  const auto is_on = [&](int row) { return on_[static_cast<std::size_t>(row)] != 0; };
  double input = least_voltage_;
  for (const int row : segment_.rows)
    if (is_on(row)) input = std::max(input, reach(row));
  const double voltage = std::max(voltage_, least_voltage_);
  free_.clear();
  idle_.clear();
  std::erase_if(segment_.rows, [&](int row) {
    const bool is_short = is_short_circuited(row);
    const double size = is_on(row) ? input : voltage;
    const bool is_empty = is_short || reach(row) <= std::min(std::max(tolerance::empty_row * terms_of(row), node_rounding(row)),
                                                             tolerance::largest_empty_row * size);
    if (is_empty && is_on(row)) idle_.push_back(row);
    if (is_empty && !is_on(row)) free_.push_back(row);
    return is_empty;
  });
}

/// What the search and the test of signs ask of a mode whose flow and guards are set, but for the noise.
void ExactSegment::bound_mode(model::Mode& m) {
  linalg::Matrix a = m.flow.a();
  m.n1 = m.ny = static_cast<int>(a.rows());
  m.regular = true;
  m.absolute_a = a.cwiseAbs();
  m.norm_a = a.norm();
  double growth = linalg::logarithmic_norm(a);
  m.growth = std::max(0.0, growth);
  if (m.growth > 0.0 && m.n1 > 1) m.scale = linalg::balance(a, growth);  // empty where nothing is to be gained
  if (m.scale.size() > 0) {
    m.scaled_growth = std::max(0.0, growth);
    m.scaled_guard_c_norm = (m.guards * m.scale.asDiagonal()).rowwise().norm();
    m.scaled_input_block_norm.resize(0);
  }
  m.absolute_guards = m.guards.cwiseAbs();
  m.guard_norm = m.guard_c_norm = m.guards.rowwise().norm();
  m.guard_block_norm.resize(m.guards.rows(), 0);
  m.input_block_norm.resize(0);
}

/// The same of the segment itself, with the noise.
void ExactSegment::bound_guards() {
  model::Mode& m = *mode_;
  m.flow = space_.flow();
  bound_mode(m);
  m.noise = noise_ * present_tolerance_;
  note_terms();
  leave_out_decays();
  note_rounding();
  for (const auto& [guard, factor] : muted_) m.guard_noise[guard] *= factor;
  if (m.guard_noise.size() > 0) m.noise = std::max(m.noise, m.guard_noise.maxCoeff());
}

/// The terms of each row, and the largest current of a port that is on, with its own.
void ExactSegment::note_terms() {
  terms_.resize(mode_->guards.rows());
  input_ = 0.0;
  for (Eigen::Index i = 0; i < terms_.size(); ++i) {
    terms_[i] = linalg::absolute_row_times(mode_->guards, i, space_.first().data());
    if (i < descriptor_.first_switch() && on_[static_cast<std::size_t>(i)] != 0) input_ = std::max(input_, terms_[i]);
  }
}

/// What a guard is measured against beside its own terms: those may be nothing but the rounding of what it is a difference of.
double ExactSegment::size_of_kind(int row) const {
  const int ports = descriptor_.first_switch();
  if (row >= ports) return std::max(rounding_size(controls_[static_cast<std::size_t>(row - ports)]), least_voltage_);
  const auto port = static_cast<std::size_t>(row);
  if (on_[port] == 0) return std::max(voltage_, least_voltage_);
  return std::min(std::max(input_, least_voltage_), size_by_leaks(port));
}

/// A row behind a leak that floats reads mostly a decay of nanoseconds. Where that is over, what is left of it in the state is rounding: it is left out of such rows, whose noise is
/// that of the slow motion then. Where it is not, or where it alone keeps a guard above zero that is below once it is over, they keep it, and their noise is that of the slow motion once they are clear
/// of what the start makes of it.
void ExactSegment::leave_out_decays() {
  model::Mode& m = *mode_;
  const linalg::Vector& y = space_.first();
  const double norm = y.norm();
  hidden_decay_ = 0.0;
  hides_sign_ = false;
  left_out_.assign(static_cast<std::size_t>(m.guards.rows()), 0);
  later_noise_.assign(static_cast<std::size_t>(m.guards.rows()), INFINITY);
  std::vector<int> far;
  for (const int row : segment_.rows)
    if (share_of_norm * m.guard_norm[row] * norm > beyond_size * std::max(size_of_kind(row), terms_[row])) far.push_back(row);
  if (far.empty()) return;
  const std::optional<linalg::FastPart> part = linalg::fast_part(m.flow.a(), space_.rates_of_motions());
  if (!part) return;
  const linalg::Vector decays = part->coordinates * y;
  const bool is_seen = length_ > tolerance::unseen_segment * stop_;
  for (const int row : far) {
    const Eigen::RowVectorXd of_decays = m.guards.row(row) * part->fast, slow = m.guards.row(row) - of_decays * part->coordinates;
    const double size = m.guard_norm[row] * norm, rounding = tolerance::left_of_decay * size, slow_value = slow.dot(y);
    const double left = std::max(of_decays.cwiseAbs().dot(decays.cwiseAbs()), rounding);
    const double own = m.noise * std::max(share_of_norm * slow.norm() * norm, slow.cwiseAbs().dot(y.cwiseAbs())), of_slow = own + rounding;
    const bool is_held_by_decay = slow_value < -of_slow && slow_value + of_decays.dot(decays) > rounding;
    if (left <= m.noise * share_of_norm * size && !is_held_by_decay) {
      m.guards.row(row) = slow;
      m.absolute_guards.row(row) = slow.cwiseAbs();
      m.guard_norm[row] = m.guard_c_norm[row] = slow.norm();
      left_out_[static_cast<std::size_t>(row)] = 1;
    } else {
      const double of_segment = estimate_ * m.guard_norm[row];
      if (of_segment > of_slow) hidden_decay_ = part->slowest;
      hides_sign_ |= is_seen && rounding + of_segment > own && std::abs(slow_value) <= of_slow + of_segment;
      later_noise_[static_cast<std::size_t>(row)] = (of_slow + of_segment) / (share_of_norm * size);
    }
  }
  note_terms();
}

/// Whether a decay that hides a guard has a segment of its own, which the habit is then made for. One that is made for a slower decay may show a faster one that hides a sign.
bool ExactSegment::ends_with_decay() {
  const double longest = most_of_length_for_decay * length_ / time_constants_of_decay;
  double rate = hidden_decay_;
  if (hides_sign_) rate = std::max(rate, linalg::find_cut(space_.rates_of_motions(), longest, 0.0).fast_rate);
  if (!(rate * longest > 1.0)) return false;
  habits_[key_].length = time_constants_of_decay / rate;
  return true;
}

/// Noise of each guard, against the terms of its own row, at the start. What passes zero within the doubt of the time at which another did passes with it.
void ExactSegment::note_rounding() {
  model::Mode& m = *mode_;
  m.guard_noise.setConstant(m.guards.rows(), m.noise);
  const double* y = space_.first().data();
  const linalg::Vector slope = m.flow.a() * space_.first();
  for (const int row : segment_.rows) {
    m.guard_noise[row] = noise_of_row(row, m.noise);
    const double doubt = doubt_ * std::abs(m.guards.row(row).dot(slope));
    if (!(std::abs(linalg::row_times(m.guards, row, y)) <= doubt)) continue;
    m.guard_noise[row] =
        std::max(m.guard_noise[row], std::min(doubt / model::guard_size(m, row, y, share_of_norm), noise_in_doubt * present_tolerance_));
  }
}

/// From `least` on.
double ExactSegment::noise_of_row(int row, double least) const {
  const model::Mode& m = *mode_;
  const double norm = m.guard_norm[row] * space_.first().norm();
  if (!(norm > 0.0)) return least;
  const int ports = descriptor_.first_switch();
  const bool is_input = row < ports && on_[static_cast<std::size_t>(row)] != 0;
  const double relaxed = is_input ? relaxation_ : 1.0;
  const double rounding = relaxed * (is_input ? tolerance::input_rounding : tolerance::voltage_rounding);
  const double held = row < ports && !is_input && jump_voltage_ == 0.0 ? held_[static_cast<std::size_t>(row)] : 0.0;
  const double known = std::max({rounding * size_of_kind(row), held, tolerance::jump_rounding * jump_voltage_});
  const double size = std::max(terms_[row], share_of_norm * norm);
  return std::max({least, tolerance::row_rounding / share_of_norm * terms_of(row) / norm, known / size});
}

/// Of guards that are clear of zero while the start is in them: what it makes of a decay's size passes with it.
void ExactSegment::note_later_rounding() {
  for (std::size_t i = 0; i < segment_.rows.size(); ++i) {
    const int row = segment_.rows[i];
    const double later = later_noise_[static_cast<std::size_t>(row)];
    if (segment_.departures[i].order != 0 || !(later < mode_->guard_noise[row])) continue;
    mode_->guard_noise[row] = noise_of_row(row, later);
  }
}

/// Guards that the noise of a decay leaves without a sign, whatever a derivative's is, have the noise of the slow motion, too: one that is above zero by more stays there until it passes.
void ExactSegment::judge_hidden() {
  for (std::size_t i = 0; i < segment_.rows.size(); ++i) {
    const int row = segment_.rows[i];
    const double later = later_noise_[static_cast<std::size_t>(row)];
    if (segment_.departures[i].order == 0 || !(later < mode_->guard_noise[row])) continue;
    mode_->guard_noise[row] = noise_of_row(row, later);
    const double value = guard(row, segment_.y0);
    if (value > rounding_of(row, segment_.y0)) segment_.departures[i] = {0, value};
  }
}

/// A port that is on holds its slack at zero as far as solutions are corrected (StartChange::closing): what is left of it there is rounding in the states, and no voltage when the port turns off.
void ExactSegment::note_instant(double time, const Position& on, const std::vector<double>& z) {
  std::vector<double> w;
  for (std::size_t i = 0; i < held_.size(); ++i) {
    if (on[i] == 0 && held_[i] == 0.0) continue;
    if (w.empty()) sources_.evaluate(time, w);
    const DescriptorPort& port = descriptor_.ports()[i];
    const double slack = std::abs(port.slack.value(z.data(), w.data()));
    if (on[i] != 0)
      held_[i] = slack > tolerance::guard_sign * port.slack_size(z.data(), w.data()) ? 0.0 : beyond_held * slack;
    else if (slack > held_[i])
      held_[i] = 0.0;
  }
}

/// Voltages of nodes are right to the last digits of the largest of all, inputs to those of the largest input, or where leaks alone meet them but for so many to those of their own and of the leaks.
double ExactSegment::terms_of(int row) const {
  const int ports = descriptor_.first_switch();
  if (row >= ports) return space_.row_terms(controls_[static_cast<std::size_t>(row - ports)].value);
  const auto port = static_cast<std::size_t>(row);
  if (on_[port] == 0) return node_terms_;
  const double by_leaks = size_by_leaks(port);
  if (!(by_leaks < input_terms_)) return input_terms_;
  const double own = tolerance::lost_terms * space_.largest_terms(descriptor_.ports()[port].row, 1);
  return std::min(input_terms_, std::max(own, by_leaks));
}

/// What currents leave of that of an ideal port that is on, where they cancel at its nodes. Where no port has more, all of them are rounding. (One with a resistance takes no more
/// than its voltage drives.)
double ExactSegment::node_rounding(int row) const {
  if (row >= descriptor_.first_switch() || on_[static_cast<std::size_t>(row)] == 0) return 0.0;
  const DescriptorPort& port = descriptor_.ports()[static_cast<std::size_t>(row)];
  const bool has_resistance =
      std::any_of(port.slack.z.begin(), port.slack.z.end(), [&](const Form::IndexedTerm& part) { return part.index == port.row; });
  return has_resistance ? 0.0 : tolerance::sum_rounding * node_terms_ * descriptor_.conductance_at(static_cast<std::size_t>(row));
}

/// Of a control: its levels, and the terms of its form.
double ExactSegment::rounding_size(const WatchedControl& control) const {
  double size = std::max(control.level_size(), control.largest);
  for (const Form::IndexedTerm& part : control.value.z) size = std::max(size, std::abs(part.coefficient) * voltage_);
  return size;
}

/// Whether a switch is on whose control stays at its threshold, where it is off.
bool ExactSegment::passes_at_rest(int row) const {
  const int ports = descriptor_.first_switch();
  if (row < ports) return false;
  const WatchedControl& control = controls_[static_cast<std::size_t>(row - ports)];
  const double margin = linalg::row_times(mode_->guards, row, segment_.y0.data());
  return control.passes_at_rest(on_) && margin <= control.noise(control.off_level + margin, std::max(voltage_, current_));
}

/// The guard that has just passed zero, and those that passed with it.
bool ExactSegment::has_just_passed(int row) const {
  const int ports = descriptor_.first_switch();
  if (row == passing_ || row < ports || passing_ < ports) return row == passing_;
  return controls_[static_cast<std::size_t>(row - ports)].passes_with(controls_[static_cast<std::size_t>(passing_ - ports)], on_);
}

void ExactSegment::note_passing(int guard, double doubt) {
  passing_ = guard;
  doubt_ = doubt;
  if (guard >= 0) passed_from_ = on_;
  if (guard < 0 || guard >= descriptor_.first_switch()) return passed_to_.clear();
  passed_to_ = on_;
  passed_to_[static_cast<std::size_t>(guard)] ^= 1;
  descriptor_.hold_blocked(passed_to_);
}

/// Whether that guard has passed zero in the very position at hand: what is left of it is no sign.
bool ExactSegment::is_taken_back(int row) const { return row == passing_ && on_ == passed_from_; }

/// Whether its port alone has changed sides. What the port begins with is then a multiple of what was zero when it passed, so that it is zero, be it the voltage that rounding of a current makes
/// across a leak.
bool ExactSegment::begins_at_zero(int row) const { return is_passive_ && row == passing_ && on_ == passed_to_; }

/// Signs right after the start: the first derivative that is not rounding decides. A parabola that dips no deeper than rounding does not fall.
void ExactSegment::judge_start() {
  segment_.system = &system_;
  segment_.mode = mode_.get();
  segment_.anchor = start_;
  segment_.longest = length_;
  segment_.passes_rest = true;
  segment_.least_noise = 0.0;
  segment_.y0.assign(space_.first().begin(), space_.first().end());
  segment_.y = segment_.y0;
  segment_.tau = segment_.certified = segment_.step = 0.0;
  segment_.intervals = 0;
  segment_.sampled = false;
  segment_.begins_sampled = samples_start_;
  segment_.turns = segment_.turns_without_modal_form = 0;
  segment_.departures.resize(segment_.rows.size());
  model::Verifier verifier;
  if (!segment_.rows.empty()) verifier.departures(*mode_, segment_.y0.data(), segment_.rows, segment_.departures.data());
  judge_hidden();
  negative_.clear();
  rising_.clear();
  const linalg::Matrix& a = mode_->flow.a();
  const linalg::Vector first = a * space_.first(), second = a * first;
  for (std::size_t i = 0; i < segment_.rows.size(); ++i) {
    model::Departure& departure = segment_.departures[i];
    if (departure.order < 0 && passes_at_rest(segment_.rows[i])) negative_.push_back(segment_.rows[i]);
    if (departure.order <= 0 && !(departure.order == 0 && departure.value < 0.0)) continue;
    const int row = segment_.rows[i];
    const double value = departure.order == 0 ? departure.value : linalg::row_times(mode_->guards, row, segment_.y0.data());
    const double slope = linalg::row_times(mode_->guards, row, first.data());
    const double soon = begins_at_zero(row) ? length_ : tolerance::just_passed * std::min(length_, expected_);
    const bool is_soon_positive = value < 0.0 && slope > 0.0 && value + soon * slope >= 0.0;
    if (is_soon_positive && (departure.value > 0.0 || has_just_passed(row))) rising_.push_back(row);
    if (departure.value > 0.0) continue;
    const double bend = linalg::row_times(mode_->guards, row, second.data());
    if (has_just_passed(row) && departure.order == 0 && is_soon_positive) {
      departure = {1, slope};
    } else if (departure.order == 1 && bend > 0.0 && departure.value * departure.value <= 2.0 * bend * rounding_of(row, segment_.y0)) {
      departure = {2, bend};
    } else if (departure.order > 0 && value > 0.0 && takes_positive_ && !is_taken_back(row)) {
      departure = {0, value};
    } else {
      negative_.push_back(row);
    }
  }
}

bool ExactSegment::changes_visibly(const Position& before) {
  const auto ports = static_cast<std::size_t>(descriptor_.first_switch());
  if (!std::equal(on_.begin() + static_cast<std::ptrdiff_t>(ports), on_.end(), before.begin() + static_cast<std::ptrdiff_t>(ports)))
    return true;
  std::vector<int> at_zero;
  for (std::size_t i = 0; i < segment_.rows.size(); ++i) {
    const auto row = static_cast<std::size_t>(segment_.rows[i]);
    if (row >= ports || on_[row] == before[row]) continue;
    if (segment_.departures[i].order >= 0) return true;
    at_zero.push_back(segment_.rows[i]);
  }
  if (at_zero.empty()) return false;
  const std::vector<double>& later = at(std::min(length_, expected_));  // a derivative at the start may be below the rounding of others
  return std::any_of(at_zero.begin(), at_zero.end(), [&](int row) { return std::abs(guard(row, later)) > rounding_of(row, later); });
}

bool ExactSegment::is_at_zero(int port, const std::vector<double>& y) const {
  const double value = guard(port, y);
  if (value >= 0.0) return left_out_[static_cast<std::size_t>(port)] != 0;
  const double rate = guard_rate(port, y);
  if (length_ <= tolerance::unseen_segment * stop_ && -value <= rounding_of(port, y)) return true;
  return -value <= tolerance::no_time * stop_ * std::abs(rate) ||
         (rate > 0.0 && std::find(rising_.begin(), rising_.end(), port) != rising_.end());
}

/// Of a guard's value at y.
double ExactSegment::rounding_of(int row, const std::vector<double>& y) const {
  return mode_->guard_noise[row] * model::guard_size(*mode_, row, y.data(), share_of_norm);
}

}  // namespace pwlsim::engine::sparse
