/// Events by eigenvectors (model/modal_form.hpp), in modes whose segments are long in their own time.

#include <algorithm>

#include "engine/exact/locator.hpp"

namespace pwlsim::engine {

namespace {

/// So many intervals in, eigenvectors are worth looking for.
constexpr std::uint64_t intervals_before_modal_form = 3;

}  // namespace

/// To the end of the segment, or its first event; some way, with no event before; or none, where eigenvectors have nothing to say. Needs first derivatives.
Locator::Progress Locator::search_modal_form(Segment& s, double end, double shortest, Located& located) {
  const model::Mode& m = *s.mode;
  if (s.part) return Progress::none;
  if (!m.modal_form_known) {
    if (s.intervals < intervals_before_modal_form) return Progress::none;
    m.modal_form = model::modal_form(*s.system, m);
    m.modal_form_known = true;
  }
  if (!m.modal_form) return Progress::none;
  modal_guards_.clear();
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const int order = s.tau == 0.0 ? s.departures[i].order : 0;
    if (order > 1 || is_at_rest(s, i)) return Progress::none;
    modal_guards_.push_back({s.rows[i], g_[i], noise_of(s, s.rows[i]), order == 1});
  }
  const std::uint64_t before = modal_search_.intervals();
  const ModalSearch::Found found = modal_search_.search(*m.modal_form, modal_guards_, s.y.data(), end - s.tau);
  intervals_ += modal_search_.intervals() - before;
  s.intervals += modal_search_.intervals() - before;
  if (found.verdict == ModalSearch::Verdict::positive) {
    s.certified = end;
    return Progress::to_end;
  }
  if (found.verdict == ModalSearch::Verdict::undecided) {
    if (found.lower < shortest) return Progress::none;
    state_at(s, found.lower, ye_.data());
    accept(s, found.lower, end);
    return Progress::some;
  }
  state_at(s, found.at, event_.data());
  double tau = s.tau + found.at;
  if (!polish(s, s.rows[found.guard], tau)) {
    tau = s.tau + go_to_root(s, found.guard, found.lower, found.upper, found.at, 0.0);
    polish(s, s.rows[found.guard], tau);
  }
  end_at_event(s, found.guard, tau, end, located);
  return Progress::to_end;
}

}  // namespace pwlsim::engine
