/// ExactSegment: how long a segment is made, with which γ, by what the position it is in has taken before.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/sparse/exact_segment.hpp"
#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

constexpr double steps_of_length = 16.0;   ///< length of a segment over γ
constexpr double steps_for_decays = 32.0;  ///< the same where decays of all rates take part, as in a grid of R and C
constexpr double ladder = 4.0;             ///< of γ, so that factors serve again
constexpr double ladder_of_turns =
    std::numbers::sqrt2;              ///< of γ where the fastest oscillation decides it: vectors for each radian depend on it
constexpr double turn_of_all = 0.85;  ///< radians of it in γ, where all vectors there are do not resolve the length: more ask for too many
constexpr double longer_turn = 1.0;   ///< the same where a shorter γ leaves no digits
constexpr double most_turn = 6.0;     ///< where it turns by more, S forgets it in digits that are not there
constexpr double same_turning = 0.5;  ///< of an oscillation: it is that one
constexpr double near = 8.0;          ///< a shift that a position has already serves within this factor
constexpr double nearer = 0.9;        ///< of the distance of another shift, in logarithms
constexpr double first_share = 1.0 / 64.0;  ///< of the run: a first segment
constexpr double longer_than_last = 1.3;    ///< a segment is made for this much more than the last in its position
constexpr double longer_than_end = 2.0;     ///< or that, where nothing ended it

}  // namespace

double ExactSegment::first_length() const { return std::min(sources_.shortest_period() / 8.0, first_share * stop_); }

double ExactSegment::usual_length(const Position& on, double longest) const {
  const auto habit = habits_.find(key(on));
  return std::min(longest, share_ * (habit != habits_.end() && habit->second.length > 0.0 ? habit->second.length : first_length()));
}

/// Whether a guard has no sign because the segment is as short as the last one in its position was: in a short one rates are rounding that a longer one tells from zero.
bool ExactSegment::is_undecided_by_habit(double longest) {
  Habit& habit = habits_[key_];
  if (share_ < 1.0 || habit.stays_undecided || !(near * habit.length < std::min(longest, first_length()))) return false;
  const bool is_undecided =
      std::any_of(segment_.departures.begin(), segment_.departures.end(), [](const auto& departure) { return departure.order < 0; });
  if (!(habit.length > 0.0)) habit.stays_undecided = is_undecided;
  return is_undecided && habit.length > 0.0;
}

double ExactSegment::steps_wanted() const { return has_all_decays_ ? steps_for_decays : steps_of_length; }

/// Whether a length wants its 1/γ for the fastest oscillation, not for its own sake.
bool ExactSegment::is_for_turning(const Habit& habit, double length) const {
  return habit.turns_many_vectors && habit.turning / habit.turn > steps_wanted() / length;
}

/// A space of few vectors is full at any γ, and has the less rounding the longer that is.
double ExactSegment::wanted_shift(const Habit& habit, double length) const {
  const double of_turning = habit.turns_many_vectors ? habit.turning / habit.turn : 0.0;
  return shift_factor_ * std::max(steps_wanted() / length, of_turning);
}

/// 1/γ of a rung.
double ExactSegment::rung_for(const Habit& habit, double length) const {
  const double base = is_for_turning(habit, length) ? ladder_of_turns : ladder;
  return shift_factor_ * std::pow(base, std::round(std::log(wanted_shift(habit, length) / shift_factor_) / std::log(base)));
}

/// 1/γ of a rung, or one that the position has a factor for.
double ExactSegment::shift_for(double length) {
  Habit& habit = habits_[key_];
  const double wanted = wanted_shift(habit, length), most = is_for_turning(habit, length) ? ladder_of_turns : near;
  double best = 0.0;
  for (const double shift : habit.shifts)
    if (std::abs(std::log(shift / wanted)) <= std::log(most) &&
        (best == 0.0 || std::abs(std::log(shift / wanted)) < std::abs(std::log(best / wanted))))
      best = shift;
  if (best > 0.0) return best;
  habit.shifts.push_back(rung_for(habit, length));
  return habit.shifts.back();
}

/// Where a length fails with a shift that was there: the shift of its own rung serves from now on, if it is nearer to what the length wants. False: it is not.
bool ExactSegment::takes_own_shift(double length, double failed) {
  Habit& habit = habits_[key_];
  const double wanted = wanted_shift(habit, length), own = rung_for(habit, length);
  if (!(std::abs(std::log(own / wanted)) < nearer * std::abs(std::log(failed / wanted)))) return false;
  habit.shifts.push_back(own);
  return true;
}

/// All vectors there are do not resolve a motion, and no oscillation asks for a shorter γ: from now on decays do.
void ExactSegment::note_all_decays() {
  if (has_all_decays_ || is_for_turning(habits_[key_], length_) ||
      space_.turning(usual_turn * space_.shift()) > usual_turn * space_.shift())
    return;
  has_all_decays_ = true;
  for (auto& [position, habit] : habits_) habit.shifts.clear();
}

/// The longer γ is, the less each vector adds to the rounding of what a constraint decides. A space that is full holds every motion at any γ; others take more vectors for a radian.
bool ExactSegment::takes_longer_turn() {
  Habit& habit = habits_[key_];
  const double longer = (space_.is_full() ? ladder : ladder_of_turns) * habit.turn;
  if (space_.dimension() < many_vectors || !is_for_turning(habit, length_)) return false;
  if (longer > (space_.is_full() ? habit.longest : longer_turn)) return false;
  habit.turn = longer;
  return true;
}

/// Where that was for a space that was full, and is not with all vectors there are.
bool ExactSegment::takes_shorter_turn() {
  Habit& habit = habits_[key_];
  if (!(habit.turn > longer_turn)) return false;
  habit.turn = habit.longest = longer_turn;
  return true;
}

/// Of a segment that its vectors have made as short as it is.
void ExactSegment::note_digits(int vectors, bool has_all) {
  Habit& habit = habits_[key_];
  habit.most_vectors = vectors;
  habit.more_vectors.note(has_all);
}

/// Whether the fastest oscillation turns by more in γ than it should, and the position did not know of it. Where all vectors there are follow what is known for many radians, there is none that is faster.
bool ExactSegment::turns_by_more(bool is_cut) {
  Habit& habit = habits_[key_];
  if (!space_.is_sound() || (is_cut && space_.dimension() < many_vectors)) return false;
  if (is_cut && length_ > 0.0 && is_for_turning(habit, length_)) return false;
  const double least = (is_cut ? turn_of_all : most_turn) * space_.shift(), turning = space_.turning(least);
  if (!(turning > least) || habit.turning >= turning || turning >= habit.no_turning) return false;
  habit.turning = turning;
  habit.turns = false;
  habit.turns_many_vectors |= space_.dimension() >= many_vectors;
  return true;
}

/// Of vectors without digits the fastest oscillation is their rounding: a space whose γ is made for it does not have it, and the position has the γ of its length again.
bool ExactSegment::forgets_turning() {
  Habit& habit = habits_[key_];
  if (habit.turns || habit.turning == 0.0 || !space_.is_sound() || !(space_.shift() * most_turn > habit.turning)) return false;
  habit.turns = space_.turning(0.0) >= same_turning * habit.turning;
  if (habit.turns) return false;
  habit.no_turning = same_turning * std::exchange(habit.turning, 0.0);
  habit.turns_many_vectors = false;
  return true;
}

void ExactSegment::note_event(double tau) { habits_[key_].length = std::max(longer_than_last * tau, tolerance::shortest_segment * stop_); }

/// A length that could not be made is tried less and less often.
void ExactSegment::note_end(double tau) {
  Habit& habit = habits_[key_];
  const double longer = longer_than_end * tau;
  habit.length = longer < habit.refused || habit.attempts.is_due() ? longer : tau;
}

void ExactSegment::note_attempt(double length, bool success) {
  Habit& habit = habits_[key_];
  if (success ? length < habit.refused : length > habit.refused) return;
  habit.refused = success ? INFINITY : length;
  habit.attempts.note(success);
}

}  // namespace pwlsim::engine::sparse
