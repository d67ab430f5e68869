#include "model/selection.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "linalg/factorisations.hpp"
#include "model/build_mode.hpp"
#include "model/tolerances.hpp"
#include "model/valves.hpp"

namespace pwlsim::model {

namespace {

constexpr int most_jumps = 20;
constexpr int most_rounds_of_rule = 4;
constexpr double s_factors[] = {30.0, 1e3, 1e5, 1e7, 1e9, 1e11};
/// Rounding levels of the verification, tried in turn.
constexpr double relaxations[] = {1.0, 1e2, coarsest_relaxation};
/// Of a guard's terms: neither rounding nor a decay that is not followed hides as much (the decay's time constant is 10⁻³ of the slow ones, and four of them are unresolved).
constexpr double hidden_share = 0.1;
constexpr double trusted_s_factor = 1e5;  ///< a jump is believed from here on without repetition

/// Goes through the sets that differ from `set` in one to `radius` of the ports first … ports − 1.
template <class Accept>
bool any_near_set(IndexSet& set, int first, int ports, int radius, const Accept& accept) {
  if (radius == 0) return false;
  for (int i = first; i < ports; ++i) {
    set.flip(i);
    if (accept(set) || any_near_set(set, i + 1, ports, radius - 1, accept)) return true;
    set.flip(i);
  }
  return false;
}

/// A jump whose impulses complementarity allows: the first that two s propose, else the first.
struct AllowedJump {
  const Mode* into = nullptr;
  Impulse impulse;
  bool repeats = false;

  void note(const Mode& mode, bool is_repeated, const Impulse& own) {
    if (own.order == 0 || (into && (repeats || !is_repeated))) return;
    into = &mode;
    repeats = is_repeated;
    impulse = own;
  }
};

}  // namespace

Selector::Selector(const System& system, Several several) : system_(system), several_(several), rational_(system), modes_(system) {
  ports_are_read_ = std::any_of(system.outputs.begin(), system.outputs.end(), std::mem_fn(&OutputRow::reads_ports)) ||
                    std::any_of(system.controls.begin(), system.controls.end(), [](const Control& c) { return c.value.reads_ports(); });
  for (int i = 0; i < system.diodes; ++i) diode_rows_.push_back(i);
  departures_.resize(static_cast<std::size_t>(system.diodes));
  y_.resize(static_cast<std::size_t>(system.size()));
  projected_.resize(static_cast<std::size_t>(system.size()));
}

bool Selector::consistent(const Mode& mode, const double* x, double* projected) const {
  const int size = system_.size();
  if (mode.n1 == system_.n) {
    linalg::copy(x, size, projected);
    return true;
  }
  linalg::multiply(mode.projector, x, projected);
  const double tolerance = tolerance::consistency_per_noise * mode.noise * verifier_.relaxation();
  return linalg::square_distance(projected, x, size) <= tolerance * tolerance * linalg::square(x, size);
}

/// The same to the rounding of the largest state there was: a state that is small, but there, does not lie in every mode.
bool Selector::strictly_consistent(const Mode& mode, const double* x, double* projected) const {
  return consistent(mode, x, projected) &&
         linalg::square_distance(projected, x, system_.size()) <= tolerance::state_rounding * tolerance::state_rounding * largest_square_;
}

/// Without a jump: in `projected_`, x as it then is.
bool Selector::lies_in(const Mode& mode, const double* x) {
  if (!mode.decays) return consistent(mode, x, projected_.data());
  const bool settles = !has_settled(mode);
  if (settles) {
    left_.resize(mode.decays->coordinates.rows());
    linalg::multiply(mode.decays->coordinates, x, left_.data());
  }
  verifier_.set_left(settles ? &left_ : nullptr);
  return consistent(mode, x, projected_.data()) || !settles || decays_unseen(mode, x);
}

bool Selector::has_settled(const Mode& slow) const { return settled_mode_ && settled_mode_->active == slow.active; }

/// Whether what x has beside the slow motion is over at once, and no guard can fall below zero on the way: a term that decays lies between its start and zero. What the slow motion does
/// meanwhile counts: where a current that begins when they do, or ends before they have, is as small as that.
bool Selector::decays_unseen(const Mode& slow, const double* x) {
  const Decays& decays = *slow.decays;
  if (!(time_constants_to_rest * decays.slowest <= modes_.unseen())) return false;
  const auto size = static_cast<Eigen::Index>(system_.size());
  const Eigen::Map<const Vector> state(x, size);
  const Vector& start = left_;
  const Vector rounding = tolerance::state_rounding * (decays.coordinates.cwiseAbs() * state.cwiseAbs());
  for (Eigen::Index k = 0; k < start.size(); ++k)
    if (decays.time_constants[k] == 0.0 && std::abs(start[k]) > rounding[k]) return false;
  coordinates_of_ = nullptr;
  to_mode(system_, slow, projected_.data(), y_.data());
  rate_.resize(y_.size());
  linalg::multiply(slow.flow.a(), y_.data(), rate_.data());
  const double norm = linalg::norm(y_.data(), slow.ny);
  const Mode& whole = modes_.mode(slow.active);
  const double size_of_x = linalg::norm(x, system_.size());
  for (Eigen::Index i = 0; i < slow.guards.rows(); ++i) {
    // Where x comes from an event, the guard that was passed is zero to the rounding that it has with its decays.
    double noise = std::max(slow.noise * slow.guard_norm[i] * norm, whole.noise * whole.guard_norm[i] * size_of_x);
    decaying_.rest = linalg::row_times(slow.guards, i, y_.data());
    decaying_.terms.clear();
    for (Eigen::Index k = 0; k < start.size(); ++k) {
      noise += std::abs(decays.guards(i, k)) * rounding[k];
      if (decays.time_constants[k] > 0.0) decaying_.terms.push_back({decays.guards(i, k) * start[k], decays.time_constants[k]});
    }
    decaying_.drift = linalg::row_times(slow.guards, i, rate_.data());
    if (!(i < system_.diodes ? decaying_.stays_above(-noise) : decaying_.keeps_sign())) return false;
  }
  return true;
}

/// The mode of the set in which x lies without a jump: its slow motion where it can be, else the mode itself; null where neither.
const Mode* Selector::holding(const double* x, const IndexSet& set) {
  ModeStore::Known& about = modes_.known(set);
  const Mode* slow = about.slow_is_known ? about.slow.get() : modes_.slow_mode(set);
  if (slow && lies_in(*slow, x)) return slow;
  if (about.brief && lies_in(*about.brief, x)) return about.brief.get();
  const Mode& m = modes_.followed(*about.mode);
  return m.regular && consistent(m, x, projected_.data()) ? &m : nullptr;
}

bool Selector::accepts(const Mode& mode, const double* x) {
  departures_of_ = &mode;
  coordinates_of_ = system_.diodes > 0 ? &mode : nullptr;
  if (system_.diodes == 0) return true;
  to_mode(system_, mode, x, y_.data());
  verifier_.departures(mode, y_.data(), diode_rows_, departures_.data());
  // A guard that was seen to cross cannot stay as it is, even where rounding of fast parts hides its slope here; unless nothing else
  // is left, and it was at rest.
  if (trigger_ >= 0 && verifier_.relaxation() == 1.0 && mode.active.contains(trigger_) == trigger_side_ &&
      departures_[static_cast<std::size_t>(trigger_)].order < 0 && mode.guard_norm[trigger_] > 0.0)
    return false;
  return std::none_of(departures_.begin(), departures_.end(), [](const Departure& d) { return d.value < 0.0; });
}

const Mode* Selector::try_without_jump(double* x, const IndexSet& set) {
  const Mode* m = holding(x, set);
  if (!m || !accepts(*m, projected_.data())) return nullptr;
  linalg::copy(projected_.data(), system_.size(), x);
  return m;
}

const Mode* Selector::remembered(double* x, const IndexSet& wanted) {
  for (const Mode* m : modes_.known(wanted).successors) {
    if (m->slow || m->decays) {  // now the slow motion, now the mode with its decays
      if (const Mode* found = try_without_jump(x, m->active); found) return found;
      continue;
    }
    if (!lies_in(*m, x) || !accepts(*m, projected_.data())) continue;
    linalg::copy(projected_.data(), system_.size(), x);
    return m;
  }
  return nullptr;
}

/// What followed by way of another mode in which x lies.
const Mode* Selector::by_way(double* x, const IndexSet& wanted) {
  for (const ModeStore::Way& way : modes_.known(wanted).ways)
    if (const Mode* held = holding(x, way.through->active); held && !accepts(*held, projected_.data()))
      if (const Mode* found = beside(x, *held, way.after); found) return found;
  return nullptr;
}

/// Impulses must push the way complementarity allows, the highest order first; a port without impulse must go on with the right sign in the
/// same mode. A passive system has one state after the jump, and what goes on there is decided anew.
bool Selector::impulse_allowed(const Mode& m, const double* x, const double* after) {
  const auto size = static_cast<Eigen::Index>(system_.size());
  const Vector jump = Eigen::Map<const Vector>(after, size) - Eigen::Map<const Vector>(x, size);
  // A small jump is the difference of large states.
  impulse_ = find_impulse(system_, rational_.rate(), m.active, jump, m.noise * linalg::norm(x, size));
  if (impulse_.order == 0) return system_.passive;
  if (std::any_of(impulse_.sign.begin(), impulse_.sign.end(), [](int sign) { return sign < 0; })) return false;
  if (system_.passive || accepts(m, after)) return true;
  for (std::size_t i = 0; i < departures_.size(); ++i)
    if (impulse_.sign[i] == 0 && departures_[i].value < 0.0) return false;
  return true;
}

/// What follows where x lies in m to rounding and m is not accepted. Ports that m leaves open may have the wrong sign in the least norm: then the
/// mode that holds those at zero goes on. Or what x is moved by into m was in the guards: then a mode goes on from there.
/// `after`: the only one to look at; null: any.
const Mode* Selector::beside(double* x, const Mode& m, const Mode* after) {
  if (const Mode* found = by_repeated_rule(x, with_falling_flipped(m.active)); found) return found;
  if (!system_.passive || !may_jump_ || m.n1 == system_.n) return nullptr;
  const Mode* found = settled(m, x, after);
  if (!found) return nullptr;
  std::copy(settled_.begin(), settled_.end(), x);
  selected_.settles |= m.decays != nullptr;
  return found;
}

/// The mode that goes on without another jump from where the jump into m leads, if there is one. A passive system jumps once: to the state nearest
/// in energy of those from which no impulse is due (Heemels, Çamlıbel, Schumacher 2003), and allowed impulses that end in such a state lead to that
/// one. `after`: the only mode to look at; null: any.
const Mode* Selector::settled(const Mode& m, const double* x, const Mode* after) {
  const int trigger = std::exchange(trigger_, -1);
  const Impulse impulse = impulse_;
  settled_.assign(x, x + system_.size());
  jump_into(m, settled_.data());
  may_jump_ = false;
  bool ignored = false;
  const Mode* found = after ? try_without_jump(settled_.data(), after->active) : search(settled_.data(), m.active, -1, ignored, ignored);
  may_jump_ = true;
  trigger_ = trigger;
  impulse_ = impulse;
  return found;
}

/// Goes on in the mode in which x lies, or beside it.
const Mode* Selector::from_held(double* x, const IndexSet& wanted, const Mode& held) {
  if (accepts(held, projected_.data())) {
    linalg::copy(projected_.data(), system_.size(), x);
    return &held;
  }
  const Mode* other = beside(x, held, nullptr);
  if (other) modes_.remember_way(wanted, {&held, other});
  return other;
}

const Mode* Selector::from_rcp(double* x, const IndexSet& wanted, bool& jumped) {
  jumped = false;
  const Mode* previous = nullptr;
  AllowedJump allowed;
  // Most candidates come at several s; what was found of one holds for all of them.
  std::vector<IndexSet> rejected;
  std::vector<const Mode*> unsettled;
  const auto is_in = [](const auto& list, const auto& what) { return std::find(list.begin(), list.end(), what) != list.end(); };
  for (const double factor : s_factors) {
    const Mode* first_jump = nullptr;
    for (const IndexSet& set : rational_.candidates(x, rational_.rate() * factor, wanted)) {
      if (is_in(rejected, set)) continue;
      if (const Mode* held = holding(x, set); held) {
        if (const Mode* found = from_held(x, wanted, *held); found) return found;
        rejected.push_back(set);
        continue;
      }
      const Mode& m = modes_.mode(set);
      if (!m.regular || !may_jump_ || !impulse_allowed(m, x, projected_.data())) continue;
      const bool repeats = &m == previous || factor >= trusted_s_factor;
      if (!system_.passive) {
        jumped = repeats;
      } else if (!is_in(unsettled, &m)) {
        jumped = settled(m, x, nullptr) != nullptr;
        unsettled.push_back(&m);
      }
      if (jumped) return jump_into(m, x);
      if (!first_jump) first_jump = &m;
      allowed.note(m, repeats, impulse_);
    }
    previous = first_jump;
  }
  if (!system_.passive) return system_.diodes > few_ports ? nullptr : from_all_modes(x, wanted, jumped);
  // At larger s the problem may be too badly scaled to be solved; the impulses that complementarity allows are those of the solution.
  jumped = allowed.into != nullptr;
  if (!jumped) return nullptr;
  impulse_ = allowed.impulse;
  return jump_into(*allowed.into, x);
}

/// Projects twice: what the rounding of P leaves outside of V is in proportion to the state before, which may have been far larger.
const Mode* Selector::jump_into(const Mode& m, double* x) {
  linalg::multiply(m.projector, x, projected_.data());
  linalg::multiply(m.projector, projected_.data(), x);
  return &m;
}

/// Lemke's method solves for P-matrices and semidefinite ones; elsewhere it can miss the solution. A mode without jump before one with.
const Mode* Selector::from_all_modes(double* x, const IndexSet& wanted, bool& jumped) {
  const Mode* stays = nullptr;
  const Mode* jump = nullptr;
  Impulse impulse;
  any_set(wanted, system_.diodes, [&](const IndexSet& set) {
    stays = try_without_jump(x, set);
    if (stays) return true;
    const Mode& m = modes_.mode(set);
    if (jump || !m.regular || consistent(m, x, projected_.data()) || !impulse_allowed(m, x, projected_.data())) return false;
    jump = &m;
    impulse = impulse_;
    return false;
  });
  if (stays) return stays;
  if (!jump) return nullptr;
  impulse_ = impulse;
  jumped = true;
  return jump_into(*jump, x);
}

/// The set after every port has changed sides whose guard is below zero in its mode by more than rounding, or decays, can hide, or falls from zero at the pace of decays. Asked before the
/// slow motion of the mode is split off, which costs four times as much as the mode; otherwise the set itself.
IndexSet Selector::with_fallen_flipped(const IndexSet& set, const double* x) {
  if (modes_.known(set).slow_is_known) return set;
  const Mode& whole = modes_.mode(set);
  if (!whole.regular || whole.constrained || !modes_.may_split(whole) || has_settled(whole)) return set;
  coordinates_of_ = nullptr;
  to_mode(system_, whole, x, y_.data());
  rate_.resize(y_.size());
  linalg::multiply(whole.flow.a(), y_.data(), rate_.data());
  IndexSet flipped = set;
  for (const int row : diode_rows_) {
    const double value = linalg::row_times(whole.guards, row, y_.data()), size = linalg::absolute_row_times(whole.guards, row, y_.data());
    const double fall = linalg::row_times(whole.guards, row, rate_.data()) / whole.norm_a;
    if (value < -hidden_share * size || value + hidden_share * fall < -whole.noise * size) flipped.flip(row);
  }
  return flipped;
}

const Mode* Selector::from_neighbourhood(double* x, const IndexSet& wanted, int radius) {
  const Mode* found = nullptr;
  IndexSet set = wanted;
  any_near_set(set, 0, system_.diodes, radius, [&](const IndexSet& near) {
    if (modes_.mode(near).regular && with_fallen_flipped(near, x) == near) found = try_without_jump(x, near);
    return found != nullptr;
  });
  return found;
}

/// Ports with u = 0 whose y is zero in this mode whatever x is: the same trajectory has them active too, and their share is then
/// decided by least norm (parallel diodes) instead of by the order of pivots. Where no signal reads what ports carry there is nothing to share.
const Mode* Selector::with_free_ports(double* x, const Mode& found) {
  if (!ports_are_read_) return &found;
  ModeStore::Known& about = modes_.known(found.active);
  if (!about.richer_is_known) {
    about.richer_is_known = true;
    IndexSet set = found.active;
    bool any = false;
    for (int i = 0; i < system_.diodes; ++i)
      if (found.guard_norm[i] == 0.0 && !set.contains(i)) {
        set.set(i, true);
        any = true;
      }
    const Mode* richer = !any                             ? nullptr
                         : found.decays                   ? modes_.slow_mode(set)
                         : modes_.slow_mode(found.active) ? nullptr
                                                          : &modes_.mode(set);
    about.richer = richer && richer->regular ? richer : nullptr;
  }
  const Mode* richer = about.richer;
  if (!richer || !richer->decays != !found.decays || !lies_in(*richer, x) || !accepts(*richer, projected_.data())) return &found;
  linalg::copy(projected_.data(), system_.size(), x);
  return richer;
}

/// The set after the port has changed sides, and with it those that share its guard (diodes in series).
IndexSet Selector::with_flipped(const IndexSet& set, int port) {
  IndexSet flipped = set;
  flipped.flip(port);
  const Mode* before = modes_.slow_mode(set);
  if (!before) before = modes_.known(set).mode.get();
  if (!before || before->guard_twin.empty()) return flipped;
  const auto& twin = before->guard_twin;
  for (int i = 0; i < system_.diodes; ++i)
    if (i != port && twin[static_cast<std::size_t>(i)] == twin[static_cast<std::size_t>(port)]) flipped.flip(i);
  return flipped;
}

IndexSet Selector::by_rule(const double* x, const IndexSet& set) {
  const Mode* m = holding(x, set);
  return !m || accepts(*m, projected_.data()) ? set : with_falling_flipped(set);
}

/// The set after every port has changed sides whose guard falls below zero by the departures at hand.
IndexSet Selector::with_falling_flipped(IndexSet set) const {
  for (int i = 0; i < system_.diodes; ++i)
    if (departures_[static_cast<std::size_t>(i)].value < 0.0) set.flip(i);
  return set;
}

/// The set, or what the rule makes of it in a few rounds: guards that are zero together to the rounding of the new mode show only there.
const Mode* Selector::by_repeated_rule(double* x, const IndexSet& set) {
  // First past modes that are out of the question, then from the set itself.
  IndexSet ahead = set;
  for (int round = 0; round < most_rounds_of_rule; ++round) {
    IndexSet next = with_fallen_flipped(ahead, x);
    if (next == ahead) break;
    ahead = std::move(next);
  }
  const Mode* found = ahead != set ? in_rounds(x, ahead) : nullptr;
  return found ? found : in_rounds(x, set);
}

const Mode* Selector::in_rounds(double* x, IndexSet set) {
  for (int round = 0; round < most_rounds_of_rule; ++round) {
    departures_of_ = nullptr;
    if (const Mode* found = try_without_jump(x, set); found) return found;
    if (!departures_of_ || departures_of_->active != set) return nullptr;  // x does not lie in it
    IndexSet next = with_falling_flipped(set);
    if (next == set) return nullptr;
    set = std::move(next);
  }
  return nullptr;
}

const Mode* Selector::search(double* x, const IndexSet& current, int trigger, bool& warm, bool& jumped) {
  // Where the state that follows is unique any verified mode will do, and what followed last time comes first.
  const bool one_way = goes_on_one_way(current);
  const Mode* found = one_way ? remembered(x, current) : nullptr;
  warm = found != nullptr;
  if (!found) {
    found = try_without_jump(x, current);
    warm = found && !(one_way && !modes_.known(current).successors.empty());
  }
  if (!found && !one_way) found = remembered(x, current);
  if (!found && may_jump_) found = by_way(x, current);
  if (!found && trigger >= 0 && trigger < system_.diodes) found = by_repeated_rule(x, with_flipped(current, trigger));
  if (!found) {
    const IndexSet guess = by_rule(x, current);
    if (guess != current) found = try_without_jump(x, guess);
  }
  // Of one diode there is only one other mode.
  if (!found && system_.passive && system_.diodes == 1) found = from_neighbourhood(x, current, 1);
  return found ? found : from_rcp(x, current, jumped);
}

/// A passive system does; of others the rational problem tells, once for each position of the switches.
bool Selector::goes_on_one_way(const IndexSet& set) {
  if (system_.passive || system_.diodes == 0) return true;
  IndexSet switches = set;
  for (int i = 0; i < system_.diodes; ++i) switches.set(i, false);
  const auto [entry, is_new] = one_way_.try_emplace(switches);
  if (is_new) entry->second = rational_.is_uniquely_solvable(switches);
  return entry->second;
}

void Selector::note_impulse() {
  const int order = impulse_.order > 0 ? impulse_.order : system_.size();
  if (selected_.jumps == 1)
    details_ = {impulse_.weight, impulse_.order != 1, order, {}};
  else {
    details_.impulse += impulse_.weight;
    details_.higher_order |= impulse_.order != 1;
    details_.order = std::max(details_.order, order);
  }
  selected_.details = &details_;
}

const Selected& Selector::stay_in(const Mode& mode) {
  selected_ = {};
  jumped_into_.clear();
  selected_.mode = &mode;
  return selected_;
}

const Selected& Selector::give_up(SelectionOutcome why, const IndexSet& current) {
  selected_.outcome = why;
  selected_.mode = &modes_.mode(current);
  return selected_;
}

/// Two guards that reach zero within rounding of each other can each, by the other's rounding, look as if it had gone first. Then no mode passes; a coarser
/// level calls them one event, at an error of the state of that level.
template <class Way>
const Mode* Selector::at_some_level(const Way& way) {
  for (const double level : relaxations) {
    verifier_.relax(level, largest_);
    if (const Mode* found = way()) return found;
  }
  return nullptr;
}

const Mode* Selector::search_at_all_levels(double* x, const IndexSet& current, int trigger, bool& warm, bool& jumped) {
  const Mode* found = at_some_level([&] { return search(x, current, trigger, warm, jumped); });
  if (!found) found = at_some_level([&] { return from_neighbourhood(x, current, system_.diodes <= 12 ? 3 : 2); });
  selected_.relaxation = std::max(selected_.relaxation, verifier_.relaxation());
  return found;
}

/// x goes on in this mode, or in one of several.
const Selected& Selector::go_on_in(double* x, const Mode& mode) {
  selected_.mode = &modes_.followed(mode);
  if (goes_on_one_way(mode.active)) return selected_;
  details_.continuations = continuations(x, mode);
  if (details_.continuations.size() == 1) return selected_;
  selected_.details = &details_;
  selected_.outcome = SelectionOutcome::several;
  if (several_ == Several::first) selected_.mode = first_of(details_.continuations);
  if (selected_.mode->active != mode.active && strictly_consistent(*selected_.mode, x, projected_.data()))
    linalg::copy(projected_.data(), system_.size(), x);
  return selected_;
}

void Selector::begin(const double* x, const IndexSet& wanted, int trigger) {
  selected_ = {};
  jumped_into_.clear();
  const double square = linalg::square(x, system_.size());
  if (square > largest_square_) {
    largest_square_ = square;
    largest_ = std::sqrt(square);
  }
  trigger_ = trigger < system_.diodes ? trigger : -1;
  trigger_side_ = trigger_ >= 0 && wanted.contains(trigger_);
}

const Selected& Selector::select(double* x, const IndexSet& wanted, int trigger) {
  begin(x, wanted, trigger);
  const IndexSet* current = &wanted;
  while (selected_.jumps <= most_jumps) {
    bool warm = false, jumped = false;
    const Mode* found = search_at_all_levels(x, *current, selected_.jumps == 0 ? trigger : -1, warm, jumped);
    if (!found) return give_up(SelectionOutcome::none, *current);
    if (!jumped) {
      if (!warm) modes_.remember(*current, *found);
      return go_on_in(x, *with_free_ports(x, *found));
    }
    ++selected_.jumps;
    jumped_into_.push_back(found);
    note_impulse();
    trigger_ = -1;
    current = &found->active;
  }
  return give_up(SelectionOutcome::too_many_jumps, *current);
}

}  // namespace pwlsim::model
