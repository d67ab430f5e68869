/// Events by eigenvectors (model/modal_form.hpp), in modes whose segments are long in their own time.

#include <algorithm>
#include <cmath>

#include "engine/exact/locator.hpp"

namespace pwlsim::engine {

namespace {

/// So many intervals in, eigenvectors are worth looking for. Of more than few states they cost 30 n³ operations, and an interval some 15 n²: as many intervals come first.
constexpr std::uint64_t intervals_before_modal_form = 3, intervals_a_state = 2;
constexpr int few_states = 24;
/// And for so many segments after one that came to that, from the first one on.
constexpr int segments_at_once = 64;
/// So few of a search are made again where the segment goes on: stepping to their end costs more.
constexpr std::uint64_t few_intervals = 4;
/// Where eigenvectors had nothing to say, turns until they are asked again; and where a guard comes near to zero, which other tests tell from a crossing.
constexpr int turns_without = 2, turns_beside_zero = 64;
/// From so many intervals on a guard that decays into its rounding is passed over as long as it is rounding at both ends of what is searched: bounds of low order would take as many intervals as
/// the fastest rate asks for.
constexpr std::uint64_t intervals_before_rest = 20'000;

bool passes_rest(const Segment& s) { return s.passes_rest || s.intervals > intervals_before_rest; }

}  // namespace

/// Whether the mode has them, and the segment, or one before it, took many intervals without them.
bool Locator::is_worth_eigenvectors(const Segment& s) {
  const model::Mode& m = *s.mode;
  const bool is_long =
      s.intervals >= (m.ny <= few_states ? intervals_before_modal_form : intervals_a_state * static_cast<std::uint64_t>(m.ny));
  if (!m.modal_form_known && is_long) {
    m.modal_form = model::modal_form(*s.system, m, s.longest);
    m.modal_form_known = true;
  }
  if (!m.modal_form) return false;
  int& left = m.modal_form->segments_at_once;
  if (left > 0 && s.intervals == 0) --left;
  if (left == 0 && is_long) left = segments_at_once;
  return left > 0;
}

Locator::Progress Locator::ask_later(Segment& s, int turns) {
  s.turns_without_modal_form = turns;
  return Progress::none;
}

/// Whether a guard that is not about to leave zero is nothing but rounding at the interval's start.
bool Locator::is_within_rounding(const Segment& s, std::size_t i) const {
  const int order = s.departures[i].order;
  return (s.tau > 0.0 || order < 0) && std::abs(g_[i]) <= noise_at_rest(s, i);
}

/// Whether those of them that are left out of the search are so at y, too.
bool Locator::rest_at(const Segment& s, const double* y) const {
  return std::all_of(resting_.begin(), resting_.end(),
                     [&](std::size_t i) { return std::abs(linalg::row_times(s.mode->guards, s.rows[i], y)) <= noise_at_rest(s, i); });
}

/// The guards are positive to the end, or some way.
Locator::Progress Locator::pass_without_root(Segment& s, double end, double shortest, const ModalSearch::Found& found, std::uint64_t used) {
  const bool is_whole = found.verdict == ModalSearch::Verdict::positive;
  if (is_whole && !resting_.empty()) {
    state_at(s, end - s.tau, ye_.data());
    if (!rest_at(s, ye_.data())) return ask_later(s, turns_without);
  }
  if (is_whole && used <= few_intervals) {
    s.certified = end;
    return Progress::to_end;
  }
  const double step = is_whole ? end - s.tau : found.lower;
  if (step < shortest) return ask_later(s, turns_without);
  s.intervals += used;
  state_at(s, step, ye_.data());
  if (!is_whole && !rest_at(s, ye_.data())) return ask_later(s, turns_without);
  const bool is_clear = std::all_of(modal_guards_.begin(), modal_guards_.end(), [&](const ModalSearch::Guard& guard) {
    return linalg::row_times(s.mode->guards, guard.row, ye_.data()) > leaving_zero * guard.noise;
  });
  if (!is_whole && !is_clear && s.intervals <= intervals_before_rest) return ask_later(s, turns_beside_zero);
  if (is_clear || !is_whole) accept(s, step, end);
  if (is_whole) s.certified = end;
  return is_whole ? Progress::to_end : Progress::some;
}

/// To the end of the segment, or its first event; some way, with no event before; or none, where eigenvectors have nothing to say. Needs first derivatives.
Locator::Progress Locator::search_modal_form(Segment& s, double end, double shortest, Located& located) {
  if (--s.turns_without_modal_form >= 0) return Progress::none;
  s.turns_without_modal_form = 0;
  if (!is_worth_eigenvectors(s)) return Progress::none;
  modal_guards_.clear();
  modal_numbers_.clear();
  resting_.clear();
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const int order = s.tau == 0.0 ? s.departures[i].order : 0;
    if (passes_rest(s) && is_within_rounding(s, i)) {
      resting_.push_back(i);
      continue;
    }
    if (order > 1 || is_at_rest(s, i)) return ask_later(s, turns_without);
    modal_guards_.push_back({s.rows[i], g_[i], noise_of(s, s.rows[i]), order == 1});
    modal_numbers_.push_back(i);
  }
  const std::uint64_t before = modal_search_.intervals();
  const ModalSearch::Found found = modal_search_.search(*s.mode->modal_form, modal_guards_, s.y.data(), end - s.tau);
  const std::uint64_t used = modal_search_.intervals() - before;
  intervals_ += used;
  if (found.verdict != ModalSearch::Verdict::root) return pass_without_root(s, end, shortest, found, used);
  ++s.intervals;
  state_at(s, found.at, event_.data());
  if (!rest_at(s, event_.data())) return ask_later(s, turns_without);
  const std::size_t number = modal_numbers_[found.guard];
  end_at_event(s, number, polish_or_search(s, number, found.lower, found.upper, found.at), end, located);
  return Progress::to_end;
}

}  // namespace pwlsim::engine
