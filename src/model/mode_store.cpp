#include "model/mode_store.hpp"

#include <algorithm>
#include <functional>

#include "model/build_mode.hpp"
#include "model/slow_apart.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

/// Decays of longer time constants than this are no fast ones, however slow the rest is: against the time that is not followed.
constexpr double brief_per_unseen = 1e4;
constexpr std::size_t most_remembered = 6;
/// How long a mode is followed at most, against the same: a hundredth of the run.
constexpr double followed_per_unseen = 1e7;

/// Whether e^{Aτ} loses digits of a motion that is followed for `time`, or the slow rates in A beside the fast ones. `rate`: of A, at least.
bool loses_digits(double rate, double time) { return rate * time * tolerance::unit_rounding > tolerance::lost_in_flow; }

/// Where the motions of a mode part: at the widest gaps, and at as few as leave no part that loses digits of its own slowest motion before that is over.
struct Parting {
  const Rates& rates;
  const std::vector<Cut>& possible;
  double norm = 1.0;  ///< ‖A‖ against the fastest rate
  std::vector<Cut> cuts{};

  /// Motions `first` … `last` − 1, of which the slowest are followed for `time`.
  void part(Eigen::Index first, Eigen::Index last, double time) {
    if (first >= last || !loses_digits(norm * std::abs(rates[static_cast<std::size_t>(first)]), time)) return;
    const Cut* widest = nullptr;
    for (const Cut& cut : possible)
      if (cut.fast > first && cut.fast < last && (!widest || cut.fast_rate * widest->slow_rate > widest->fast_rate * cut.slow_rate))
        widest = &cut;
    if (!widest) return;
    part(first, widest->fast, std::min(time, time_constants_to_rest / widest->fast_rate));
    cuts.push_back(*widest);
    part(widest->fast, last, time);
  }
};

}  // namespace

ModeStore::Entry& ModeStore::look_up(const IndexSet& set) {
  Entry& entry = *known_.try_emplace(set).first;
  recent_[next_recent_++ % recent_.size()] = &entry;
  return entry;
}

const Mode& ModeStore::mode(const IndexSet& set) {
  auto& slot = known(set).mode;
  if (!slot) slot = build_mode(system_, set);
  return *slot;
}

const Mode* ModeStore::slow_mode(const IndexSet& set) {
  Known& about = known(set);
  if (!about.slow_is_known) {
    about.slow_is_known = true;
    const Mode& whole = mode(set);
    if (may_split(whole)) split(about, whole);
  }
  return about.slow.get();
}

/// Only where its digits are lost by the time at which the decays are over: else guards at zero keep the entries that are zero in the mode's own coordinates.
const Mode& ModeStore::followed(const Mode& mode) {
  if (mode.decays) return mode;
  Known& about = known(mode.active);
  if (about.slow_is_known && !about.apart_is_known) {
    about.apart_is_known = true;
    if (may_split(mode)) about.apart = build_apart(about, mode);
  }
  return about.apart ? *about.apart : mode;
}

std::unique_ptr<Mode> ModeStore::build_apart(const Known& about, const Mode& whole) {
  const double time = about.slow ? time_constants_to_rest * about.slow->decays->slowest : followed_per_unseen * unseen_;
  if (!whole.regular || whole.ny == 0 || !loses_digits(whole.norm_a, time)) return nullptr;
  return apart(about, whole, whole, rates_by_speed(whole, brief_per_unseen * unseen_), time);
}

/// `mode`, which is `whole` or its slow motion and followed for `time`, with the slowest motion apart from the next faster one, both from the one that is faster again, and so on; null
/// where there is none.
std::unique_ptr<Mode> ModeStore::apart(const Known& about, const Mode& whole, const Mode& mode, const Rates& rates, double time) {
  const auto first = static_cast<Eigen::Index>(whole.n1 - mode.n1), count = static_cast<Eigen::Index>(rates.size());
  if (first >= count) return nullptr;
  const std::vector<Cut> possible = find_cuts(system_, rates, brief_per_unseen * unseen_);
  Parting parting{rates, possible, mode.norm_a / std::abs(rates[static_cast<std::size_t>(first)])};
  const Eigen::Index own = about.slow ? whole.n1 - about.slow->n1 : 0;  // a cut that there is already
  parting.part(first, own > first ? own : count, time);
  std::vector<Cut> cuts = std::move(parting.cuts);
  for (const Cut& cut : possible)
    if (own > first && cut.fast == own) cuts.push_back(cut);
  std::vector<std::unique_ptr<Mode>> made;
  const auto keep = [&](std::unique_ptr<Mode> next) { return made.emplace_back(std::move(next)).get(); };
  const Mode* slower = nullptr;
  for (auto cut = cuts.rbegin(); cut != cuts.rend(); ++cut) {
    const auto is_at_cut = [&](const std::unique_ptr<Mode>& known) { return known && known->n1 + cut->fast == whole.n1; };
    const Mode* slow = is_at_cut(about.slow) ? about.slow.get() : is_at_cut(about.brief) ? about.brief.get() : nullptr;
    if (!slow) slow = keep(build_slow_mode(system_, whole, *cut, shifted_));
    if (!slow) continue;
    slower = slower && !slow->apart ? keep(with_slow_apart(system_, *slow, *slower)) : slow;
  }
  return slower ? with_slow_apart(system_, mode, *slower) : nullptr;
}

bool ModeStore::may_split(const Mode& whole) const {
  return unseen_ > 0.0 && system_.ports > 0 && whole.norm_a * brief_per_unseen * unseen_ > 1.0;
}

/// Decays that are followed beside far faster ones that are not (an inductor behind 1 TΩ and one behind 1 MΩ) are split off alone, too: in the mode itself each of
/// their time constants would be millions of the others.
void ModeStore::split(Known& about, const Mode& whole) {
  if (!whole.regular || whole.ny == 0) return;
  const double longest = brief_per_unseen * unseen_;
  const Rates rates = rates_by_speed(whole, longest);
  const Cut cut = find_cut(system_, rates, longest);
  about.slow = build_slow_mode(system_, whole, cut, shifted_);
  if (const double time = followed_per_unseen * unseen_; about.slow && loses_digits(about.slow->norm_a, time))
    if (auto made = apart(about, whole, *about.slow, rates, time)) about.slow = std::move(made);
  whole.slow = about.slow.get();
  if (!about.slow || time_constants_to_rest * about.slow->decays->slowest <= unseen_) return;
  const Cut brief = find_cut(system_, rates, unseen_ / time_constants_to_rest);
  if (brief.fast == cut.fast) return;
  about.brief = build_slow_mode(system_, whole, brief, shifted_);
  if (about.brief) about.brief->slow = about.slow.get();
}

/// A mode and its slow motions are one.
void ModeStore::mark_visited(const Mode& mode) {
  if (mode.visits++ > 0) return;
  const Known& about = known(mode.active);
  const auto was_visited = [&](const std::unique_ptr<Mode>& twin) { return twin && twin.get() != &mode && twin->visits > 0; };
  if (!was_visited(about.mode) && !was_visited(about.slow) && !was_visited(about.brief) && !was_visited(about.apart)) ++visited_;
}

void ModeStore::remember(const IndexSet& wanted, const Mode& after) {
  auto& list = known(wanted).successors;
  std::erase_if(list, [&](const Mode* m) { return m == &after || m->active == after.active; });
  list.insert(list.begin(), &after);
  if (list.size() > most_remembered) list.pop_back();
}

void ModeStore::remember_way(const IndexSet& wanted, const Way& way) {
  auto& list = known(wanted).ways;
  list.insert(list.begin(), way);
  if (list.size() > most_remembered) list.pop_back();
}

/// Ports that are zero on both sides may stand on either: where many are active a part may float, where few are a current may circulate.
Matrix ModeStore::open_directions(const Mode& mode) const {
  IndexSet most = mode.active, fewest = mode.active;
  for (int i = 0; i < system_.diodes; ++i)
    if (mode.guard_norm[i] == 0.0) {
      most.set(i, true);
      fewest.set(i, false);
    }
  Matrix directions = mode.free_inputs.cols() > 0 ? mode.free_inputs : Matrix(system_.ports, 0);
  for (const IndexSet& set : {most, fewest}) {
    if (set == mode.active) continue;
    const auto known = known_.find(set);
    const Matrix found =
        known != known_.end() && known->second.mode ? known->second.mode->free_inputs : build_mode(system_, set)->free_inputs;
    if (found.cols() == 0) continue;
    Matrix both(system_.ports, directions.cols() + found.cols());
    both << directions, found;
    directions = std::move(both);
  }
  return directions;
}

std::vector<std::size_t> ModeStore::open_outputs() const {
  std::vector<char> open(system_.outputs.size(), 0);
  if (std::none_of(system_.outputs.begin(), system_.outputs.end(), std::mem_fn(&OutputRow::reads_ports))) return {};
  for (const auto& [set, known] : known_) {
    const Mode* visited = nullptr;
    for (const auto* mode : {&known.mode, &known.apart, &known.brief, &known.slow})
      if (*mode && (*mode)->visits > 0) visited = mode->get();
    if (!visited) continue;
    const Matrix directions = open_directions(*visited);
    if (directions.cols() == 0) continue;
    for (std::size_t i = 0; i < open.size(); ++i) {
      const Vector moved = directions.transpose() * system_.outputs[i].input;
      const Vector size = directions.cwiseAbs().transpose() * system_.outputs[i].input.cwiseAbs();
      if (((moved.cwiseAbs() - tolerance::open_signal * size).array() > 0.0).any()) open[i] = 1;
    }
  }
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < open.size(); ++i)
    if (open[i] != 0) numbers.push_back(i);
  return numbers;
}

double ModeStore::rate_doubt() const {
  double doubt = 0.0;
  for (const auto& [set, known] : known_)
    for (const auto* mode : {&known.brief, &known.slow})
      if (*mode && (*mode)->visits > 0) doubt = std::max(doubt, (*mode)->decays->rate_doubt);
  return doubt;
}

}  // namespace pwlsim::model
