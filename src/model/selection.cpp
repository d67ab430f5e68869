#include "model/selection.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "model/static_neighbours.hpp"

namespace pwlsim::model {

namespace {

/// ‖P x − x‖ below this multiple of a mode's rounding level, against ‖x‖, is no jump.
constexpr double consistency_per_noise = 30.0;
/// Of a state, against the largest there was.
constexpr double state_rounding = 30.0 * 2.220446049250313e-16;
constexpr int most_jumps = 20;
constexpr int most_rounds_of_rule = 4;
constexpr double s_factors[] = {30.0, 1e3, 1e5, 1e7, 1e9, 1e11};
/// Rounding levels of the verification, tried in turn.
constexpr double relaxations[] = {1.0, 1e2, 1e4};
constexpr double trusted_s_factor = 1e5;  ///< a jump is believed from here on without repetition
constexpr std::size_t most_remembered = 6;
/// A signal moves along an open direction of u when its terms do not cancel there.
constexpr double open_tolerance = 1e-9;
/// By a guard, against ‖row‖·‖y‖; and against the mode's own rounding.
constexpr double clearly_violated = 1e-6, clearly_above_noise = 1e3;
constexpr std::size_t most_neighbours =
    100;                      ///< modes tried for further continuations where there are more, so that an event does not take seconds
constexpr int few_ports = 6;  ///< with so many all modes are tried where nothing else helps, and for further continuations
/// Continuations of two modes differ when a derivative does by this fraction.
constexpr double alike_tolerance = 1e-9;
/// What is left of derivatives that are zero, against the state (and of u and y, times the largest row that gives them).
constexpr double derivative_noise = 1e-15;

/// Goes through all sets of the first `ports` ports, the others as they are in `set`, until accept(set) is true.
template <class Accept>
bool any_set(IndexSet set, int ports, const Accept& accept) {
  for (unsigned bits = 0; bits < (1U << static_cast<unsigned>(ports)); ++bits) {
    for (int i = 0; i < ports; ++i) set.set(i, ((bits >> static_cast<unsigned>(i)) & 1U) != 0);
    if (accept(set)) return true;
  }
  return false;
}

/// The same through the sets that differ from `set` in one to `radius` of the ports first … ports − 1.
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

}  // namespace

Selector::Selector(const System& system, Several several) : system_(system), several_(several), rational_(system) {
  for (int i = 0; i < system.diodes; ++i) diode_rows_.push_back(i);
  departures_.resize(static_cast<std::size_t>(system.diodes));
  y_.resize(static_cast<std::size_t>(system.size()));
  projected_.resize(static_cast<std::size_t>(system.size()));
}

Selector::Known& Selector::known(const IndexSet& set) {
  for (Entry* entry : recent_)
    if (entry && entry->first == set) return entry->second;
  Entry& entry = *known_.try_emplace(set).first;
  recent_[next_recent_++ % recent_.size()] = &entry;
  return entry.second;
}

const Mode& Selector::mode(const IndexSet& set) {
  auto& slot = known(set).mode;
  if (!slot) slot = build_mode(system_, set);
  return *slot;
}

void Selector::mark_visited(const Mode& mode) {
  if (mode.visits++ == 0) ++visited_;
}

/// Ports that are zero on both sides may stand on either: where many are active a part may float, where few are a current may circulate.
Matrix Selector::open_directions(const Mode& mode) const {
  IndexSet most = mode.active, fewest = mode.active;
  for (int i = 0; i < system_.diodes; ++i)
    if (mode.guard_norm[i] == 0.0) {
      most.set(i, true);
      fewest.set(i, false);
    }
  Matrix directions = mode.free_inputs.cols() > 0 ? mode.free_inputs : Matrix(system_.ports, 0);
  for (const IndexSet& set : {most, fewest}) {
    if (set == mode.active) continue;
    const Matrix found = build_mode(system_, set)->free_inputs;
    if (found.cols() == 0) continue;
    Matrix both(system_.ports, directions.cols() + found.cols());
    both << directions, found;
    directions = std::move(both);
  }
  return directions;
}

std::vector<std::size_t> Selector::open_outputs() const {
  std::vector<char> open(system_.outputs.size(), 0);
  const bool any_reads_ports =
      std::any_of(system_.outputs.begin(), system_.outputs.end(), [](const OutputRow& row) { return !row.input.isZero(0.0); });
  if (!any_reads_ports) return {};
  for (const auto& [set, known] : known_) {
    if (!known.mode || known.mode->visits == 0) continue;
    const Matrix directions = open_directions(*known.mode);
    if (directions.cols() == 0) continue;
    for (std::size_t i = 0; i < open.size(); ++i) {
      const Vector moved = directions.transpose() * system_.outputs[i].input;
      const Vector size = directions.cwiseAbs().transpose() * system_.outputs[i].input.cwiseAbs();
      if (((moved.cwiseAbs() - open_tolerance * size).array() > 0.0).any()) open[i] = 1;
    }
  }
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < open.size(); ++i)
    if (open[i] != 0) numbers.push_back(i);
  return numbers;
}

bool Selector::consistent(const Mode& mode, const double* x, double* projected) const {
  const int size = system_.size();
  if (!mode.constrained) {
    std::copy(x, x + size, projected);
    return true;
  }
  linalg::multiply(mode.projector, x, projected);
  return linalg::distance(projected, x, size) <= consistency_per_noise * mode.noise * verifier_.relaxation() * linalg::norm(x, size);
}

/// The same to the rounding of the largest state there was: a state that is small, but there, does not lie in every mode.
bool Selector::strictly_consistent(const Mode& mode, const double* x, double* projected) const {
  return consistent(mode, x, projected) && linalg::distance(projected, x, system_.size()) <= state_rounding * largest_;
}

bool Selector::accepts(const Mode& mode, const double* x) {
  departures_of_ = &mode;
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
  const Mode& m = mode(set);
  if (!m.regular || !consistent(m, x, projected_.data()) || !accepts(m, projected_.data())) return nullptr;
  std::copy(projected_.begin(), projected_.end(), x);
  return &m;
}

const Mode* Selector::remembered(double* x, const IndexSet& wanted) {
  for (const Mode* m : known(wanted).successors) {
    if (!consistent(*m, x, projected_.data()) || !accepts(*m, projected_.data())) continue;
    std::copy(projected_.begin(), projected_.end(), x);
    return m;
  }
  return nullptr;
}

void Selector::remember(const IndexSet& wanted, const Mode& mode) {
  auto& list = known(wanted).successors;
  std::erase(list, &mode);
  list.insert(list.begin(), &mode);
  if (list.size() > most_remembered) list.pop_back();
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
const Mode* Selector::beside(double* x, const Mode& m) {
  if (const Mode* found = try_without_jump(x, with_falling_flipped(m.active)); found) return found;
  if (!system_.passive || !may_jump_ || !m.constrained) return nullptr;
  const Mode* found = settled(m, x);
  if (found) std::copy(settled_.begin(), settled_.end(), x);
  return found;
}

/// The mode that goes on without another jump from where the jump into m leads, if there is one. A passive system jumps once: to the state nearest
/// in energy of those from which no impulse is due (Heemels, Çamlıbel, Schumacher 2003), and allowed impulses that end in such a state lead to that
/// one.
const Mode* Selector::settled(const Mode& m, const double* x) {
  const int trigger = std::exchange(trigger_, -1);
  const Impulse impulse = impulse_;
  settled_.assign(x, x + system_.size());
  jump_into(m, settled_.data());
  may_jump_ = false;
  bool ignored = false;
  const Mode* found = search(settled_.data(), m.active, -1, ignored, ignored);
  may_jump_ = true;
  trigger_ = trigger;
  impulse_ = impulse;
  return found;
}

const Mode* Selector::from_rcp(double* x, const IndexSet& wanted, bool& jumped) {
  jumped = false;
  const Mode* previous = nullptr;
  const Mode* jump = nullptr;
  bool jump_repeats = false;
  Impulse impulse;
  for (const double factor : s_factors) {
    const Mode* first_jump = nullptr;
    for (const IndexSet& set : rational_.candidates(x, rational_.rate() * factor, wanted)) {
      const Mode& m = mode(set);
      if (!m.regular) continue;
      if (consistent(m, x, projected_.data())) {
        if (!accepts(m, projected_.data())) {
          if (const Mode* other = beside(x, m); other) return other;
          continue;
        }
        std::copy(projected_.begin(), projected_.end(), x);
        return &m;
      }
      if (!may_jump_ || !impulse_allowed(m, x, projected_.data())) continue;
      const bool repeats = &m == previous || factor >= trusted_s_factor;
      jumped = system_.passive ? settled(m, x) != nullptr : repeats;
      if (jumped) return jump_into(m, x);
      if (!first_jump) first_jump = &m;
      if (impulse_.order > 0 && (!jump || (repeats && !jump_repeats))) {
        jump = &m;
        jump_repeats = repeats;
        impulse = impulse_;
      }
    }
    previous = first_jump;
  }
  if (!system_.passive) return system_.diodes > few_ports ? nullptr : from_all_modes(x, wanted, jumped);
  // At larger s the problem may be too badly scaled to be solved; the impulses that complementarity allows are those of the solution.
  jumped = jump != nullptr;
  if (!jumped) return nullptr;
  impulse_ = impulse;
  return jump_into(*jump, x);
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
    const Mode& m = mode(set);
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

const Mode* Selector::from_neighbourhood(double* x, const IndexSet& wanted, int radius) {
  const Mode* found = nullptr;
  IndexSet set = wanted;
  any_near_set(set, 0, system_.diodes, radius, [&](const IndexSet& near) {
    found = try_without_jump(x, near);
    return found != nullptr;
  });
  return found;
}

/// Two verified modes are one solution if x departs alike and Δu_i·Δy_i = 0 at every port: then only what no power tells apart
/// differs (the split between parallel diodes, the potential of a floating part).
bool Selector::continues_alike(const Mode& a, const Mode& b, const double* x) const {
  Vector za(system_.size()), zb(system_.size()), moved(system_.size());
  Vector ua(system_.ports), ub(system_.ports), ya(system_.ports), dy(system_.ports);
  // In the coordinates of each mode, so that rounding does not leave its subspace, where it could grow.
  Vector ca(a.ny), cb(b.ny);
  to_mode(system_, a, x, ca.data());
  to_mode(system_, b, x, cb.data());
  double size = linalg::norm(x, system_.size());
  double rounding = derivative_noise * size;
  const double largest_row = std::sqrt(std::max(
      {a.k.rowwise().squaredNorm().maxCoeff(), b.k.rowwise().squaredNorm().maxCoeff(), system_.c.rowwise().squaredNorm().maxCoeff()}));
  const double growth = std::max({1.0, a.norm_a / rational_.rate(), b.norm_a / rational_.rate()});
  for (int j = 0; j <= system_.size(); ++j, rounding *= growth) {
    from_mode(system_, a, ca.data(), za.data());
    from_mode(system_, b, cb.data(), zb.data());
    size = std::max({size * 1e-3, za.norm(), zb.norm()});
    if ((za - zb).norm() > alike_tolerance * size + rounding) return false;
    linalg::multiply(a.k, za.data(), ua.data());
    linalg::multiply(b.k, zb.data(), ub.data());
    linalg::multiply(system_.c, za.data(), ya.data());
    const double port_size = std::max({ua.cwiseAbs().maxCoeff(), ub.cwiseAbs().maxCoeff(), ya.cwiseAbs().maxCoeff()});
    moved = za - zb;
    linalg::multiply(system_.c, moved.data(), dy.data());
    const Vector du = ua - ub;
    linalg::multiply(system_.d, du.data(), ya.data());
    dy += ya;
    for (int i = 0; i < system_.ports; ++i)
      if (std::min(std::abs(du[i]), std::abs(dy[i])) > alike_tolerance * port_size + rounding * largest_row) return false;
    ca = a.flow.a() * ca / rational_.rate();
    cb = b.flow.a() * cb / rational_.rate();
  }
  return true;
}

/// Whether a guard is below zero at x already, far beyond rounding: what `accepts` would find with its derivatives, for less.
bool Selector::is_violated(const Mode& mode, const double* x) {
  to_mode(system_, mode, x, y_.data());
  const double tolerance = std::max(clearly_violated, clearly_above_noise * mode.noise * verifier_.relaxation());
  const double norm = linalg::norm(y_.data(), mode.ny);
  for (int i = 0; i < system_.diodes; ++i)
    if (linalg::row_times(mode.guards, i, y_.data()) < -tolerance * mode.guard_norm[i] * norm) return true;
  return false;
}

/// Where no certificate promises uniqueness: the verified modes that continue differently, one of each kind, `chosen` among them. All
/// modes are tried where there are few, else those that have one or two ports otherwise than the chosen one.
std::vector<const Mode*> Selector::continuations(const double* x, const Mode& chosen) {
  const std::vector<double> copy(x, x + system_.size());
  std::vector<const Mode*> found{&chosen};
  const auto keep_if_new = [&](const IndexSet& set) {
    const Mode& m = mode(set);
    if (&m == &chosen || !m.regular || !strictly_consistent(m, copy.data(), projected_.data()) || is_violated(m, projected_.data()) ||
        !accepts(m, projected_.data()))
      return false;
    if (std::none_of(found.begin(), found.end(), [&](const Mode* other) { return continues_alike(*other, m, copy.data()); }))
      found.push_back(&m);
    return false;
  };
  if (system_.diodes <= few_ports) {
    any_set(chosen.active, system_.diodes, keep_if_new);
    return found;
  }
  const StaticNeighbours neighbours(system_, chosen.active, x, largest_);
  std::vector<std::pair<int, int>> flips;  // equal: one port
  for (int i = 0; i < system_.diodes; ++i)
    for (int j = i; j < system_.diodes; ++j)
      if (i == j ? neighbours.may_flip(i) : neighbours.may_flip(i, j)) flips.emplace_back(i, j);
  if (flips.size() > most_neighbours) {
    std::stable_partition(flips.begin(), flips.end(), [](const auto& flip) { return flip.first == flip.second; });
    flips.resize(most_neighbours);
  }
  for (const auto& [i, j] : flips) {
    IndexSet set = chosen.active;
    set.flip(i);
    if (j != i) set.flip(j);
    keep_if_new(set);
  }
  return found;
}

/// Of several: the first has u = 0 in the earliest port in which they differ.
const Mode* Selector::first_of(const std::vector<const Mode*>& modes) const {
  return *std::min_element(modes.begin(), modes.end(), [&](const Mode* a, const Mode* b) {
    for (int i = 0; i < system_.diodes; ++i)
      if (a->active.contains(i) != b->active.contains(i)) return b->active.contains(i);
    return false;
  });
}

/// Ports with u = 0 whose y is zero in this mode whatever x is: the same trajectory has them active too, and their share is then
/// decided by least norm (parallel diodes) instead of by the order of pivots.
const Mode* Selector::with_free_ports(double* x, const Mode& found) {
  Known& about = known(found.active);
  if (!about.richer_is_known) {
    about.richer_is_known = true;
    IndexSet set = found.active;
    bool any = false;
    for (int i = 0; i < system_.diodes; ++i)
      if (found.guard_norm[i] == 0.0 && !set.contains(i)) {
        set.set(i, true);
        any = true;
      }
    const Mode* richer = any ? &mode(set) : nullptr;
    about.richer = richer && richer->regular ? richer : nullptr;
  }
  const Mode* richer = about.richer;
  if (!richer || !consistent(*richer, x, projected_.data()) || !accepts(*richer, projected_.data())) return &found;
  std::copy(projected_.begin(), projected_.end(), x);
  return richer;
}

/// The set after the port has changed sides, and with it those that share its guard (diodes in series).
IndexSet Selector::with_flipped(const IndexSet& set, int port) {
  IndexSet flipped = set;
  flipped.flip(port);
  const Mode* before = known(set).mode.get();
  if (!before || before->guard_twin.empty()) return flipped;
  const auto& twin = before->guard_twin;
  for (int i = 0; i < system_.diodes; ++i)
    if (i != port && twin[static_cast<std::size_t>(i)] == twin[static_cast<std::size_t>(port)]) flipped.flip(i);
  return flipped;
}

IndexSet Selector::by_rule(const double* x, const IndexSet& set) {
  const Mode& m = mode(set);
  if (!m.regular || !consistent(m, x, projected_.data()) || accepts(m, projected_.data())) return set;
  return with_falling_flipped(set);
}

/// The set after every port has changed sides whose guard falls below zero by the departures at hand.
IndexSet Selector::with_falling_flipped(IndexSet set) const {
  for (int i = 0; i < system_.diodes; ++i)
    if (departures_[static_cast<std::size_t>(i)].value < 0.0) set.flip(i);
  return set;
}

/// The set, or what the rule makes of it in a few rounds: guards that are zero together to the rounding of the new mode show only there.
const Mode* Selector::by_repeated_rule(double* x, IndexSet set) {
  for (int round = 0; round < most_rounds_of_rule; ++round) {
    departures_of_ = nullptr;
    if (const Mode* found = try_without_jump(x, set); found) return found;
    if (!departures_hold_for(mode(set))) return nullptr;  // x does not lie in it
    IndexSet next = with_falling_flipped(set);
    if (next == set) return nullptr;
    set = std::move(next);
  }
  return nullptr;
}

const Mode* Selector::search(double* x, const IndexSet& current, int trigger, bool& warm, bool& jumped) {
  if (rational_only_) return from_rcp(x, current, jumped);
  // In a passive system the state that follows is unique, so any verified mode will do, and what followed last time comes first.
  const Mode* found = system_.passive ? remembered(x, current) : nullptr;
  warm = found != nullptr;
  if (!found) {
    found = try_without_jump(x, current);
    warm = found && !(system_.passive && !known(current).successors.empty());
  }
  if (!found && !system_.passive) found = remembered(x, current);
  if (!found && trigger >= 0 && trigger < system_.diodes) found = by_repeated_rule(x, with_flipped(current, trigger));
  if (!found) {
    const IndexSet guess = by_rule(x, current);
    if (guess != current) found = try_without_jump(x, guess);
  }
  if (!found) found = from_rcp(x, current, jumped);
  if (!found) found = from_neighbourhood(x, current, system_.diodes <= 12 ? 3 : 2);
  return found;
}

void Selector::note_impulse(Selected& result) {
  const int order = impulse_.order > 0 ? impulse_.order : system_.size();
  if (result.jumps == 1)
    details_ = {impulse_.weight, impulse_.order != 1, order, {}};
  else {
    details_.impulse += impulse_.weight;
    details_.higher_order |= impulse_.order != 1;
    details_.order = std::max(details_.order, order);
  }
  result.details = &details_;
}

Selected Selector::select(double* x, const IndexSet& wanted, int trigger) {
  Selected result;
  IndexSet current = wanted;
  largest_ = std::max(largest_, linalg::norm(x, system_.size()));
  trigger_ = trigger < system_.diodes ? trigger : -1;
  trigger_side_ = trigger_ >= 0 && wanted.contains(trigger_);
  while (result.jumps <= most_jumps) {
    const Mode* found = nullptr;
    bool warm = false;
    bool jumped = false;
    // Two guards that reach zero within rounding of each other can each, by the other's rounding, look as if it had gone first.
    // Then no mode passes; a coarser level calls them one event, at an error of the state of that level.
    for (const double level : relaxations) {
      verifier_.relax(level, largest_);
      found = search(x, current, result.jumps == 0 ? trigger : -1, warm, jumped);
      if (found) break;
    }
    result.relaxation = verifier_.relaxation();
    if (!found) {
      result.choice = Choice::none;
      result.mode = &mode(current);
      return result;
    }
    if (jumped) {
      ++result.jumps;
      note_impulse(result);
      trigger_ = -1;
      current = found->active;
      continue;
    }
    if (!warm) remember(current, *found);
    found = with_free_ports(x, *found);
    result.mode = found;
    if (system_.passive || system_.diodes == 0) return result;
    details_.continuations = continuations(x, *found);
    if (details_.continuations.size() == 1) return result;
    result.details = &details_;
    result.choice = Choice::several;
    if (several_ == Several::first) result.mode = first_of(details_.continuations);
    if (result.mode != found && strictly_consistent(*result.mode, x, projected_.data())) std::copy(projected_.begin(), projected_.end(), x);
    return result;
  }
  result.choice = Choice::too_many_jumps;
  result.mode = &mode(current);
  return result;
}

}  // namespace pwlsim::model
