/// PartRun: the search for the segment that follows an instant.
///
/// The position that the passage leads to is tried at once: in a passive network it is the one that follows where no state jumps in it and no guard departs
/// downwards. Else Euler steps find the position, those that a segment's first derivatives contradict at other lengths; a state that jumps takes the
/// jump of the first of them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/sparse/part_run.hpp"
#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

constexpr double euler_share = 1e-4, euler_room = 1.0 / 64.0;  ///< Euler steps, of the segment to come, and of what is known to happen next
constexpr std::array<double, 4> euler_scales{1.0, 16.0, 0x1p-12, 0x1p-18};
constexpr double shared_jump = 0.5;           ///< of a jump: how far beside it a step that takes it may end
constexpr int most_jumps = 8;                 ///< one after the other at an instant
constexpr int most_flips = 8, few_flips = 2;  ///< rounds
enum class Ways { directly, directly_or_by_ties, by_steps, all };
/// Of signs, where they agree in no position; before that solutions with all their digits, where no state jumps, a closer look at what is fast, and, where nothing follows that, its decay as a jump.
/// A guard whose sign is rounding is first tried on both sides, and what is fast looked at more closely, as steps cost a factor for each length and position. At the start what is given
/// jumps by a step only where shorter segments do not follow what is fast.
struct Relaxation {
  double factor = 1.0;
  bool takes_positive = false;
  Ways ways = Ways::all;
  double length = 1.0;
  bool refines = false, jumps = true, decays_jump = false, given_jumps = false;
};
constexpr std::array<Relaxation, 10> relaxations{{{.ways = Ways::directly_or_by_ties},
                                                  {.takes_positive = true, .ways = Ways::directly},
                                                  {.ways = Ways::directly, .length = 0x1p-8},
                                                  {.ways = Ways::by_steps},
                                                  {.refines = true, .jumps = false},
                                                  {.takes_positive = true},
                                                  {.length = 0x1p-12},
                                                  {.length = 0x1p-24},
                                                  {.decays_jump = true, .given_jumps = true},
                                                  {.factor = 100.0, .takes_positive = true, .given_jumps = true}}};
/// Tolerances of a segment: what counts as rounding of signs, and where steps find the position, or the run has not moved since the last one.
constexpr double wide_noise = 100.0;
constexpr double shortest_with_jumps = 1e-5;  ///< of the usual length: in steps for shorter segments impulses leave states no digits
constexpr char idle_mark = 2;                 ///< of a port that is on and carries nothing

}  // namespace

/// Until what is known to happen next. A segment that begins where the run ends, as a source jumps there, has the room that it would have if the run went on: signs are not to be judged in one of
/// rounding's size.
double PartRun::room() const {
  const double next = next_break(), time = point_.time;
  if (is_same_instant(time, request_.stop)) return std::min(next, 2.0 * request_.stop) - time;
  return std::min(next, request_.stop) - time;
}

ExactSegment::Opened PartRun::open_segment(const Position& on) {
  if (++openings_ > most_openings_ && most_openings_ > 0) {
    if (failure_.id.empty()) fail(Outcome::no_solution, "E-no-solution", "the search for a position takes too long", {});
    return ExactSegment::Opened::unresolved;
  }
  const double longest = std::max(room(), break_tolerance_);
  return segment_->open(factors_, {point_.time, on, point_.z, start_memory_, longest});
}

/// Where switches change at a known instant, diodes mostly do as well: that position is tried first.
bool PartRun::follows_as_foretold(const Position& candidate) {
  const bool switches_change = passing_ < 0 && !position_before_.empty() && candidate != position_before_;
  if (starting_ || !forecast_ || !switches_change || !foretelling_.is_due()) return false;
  Position on = candidate;
  const bool is_found = forecast_->find(point_.time, point_.z, on) && open_segment(on) == ExactSegment::Opened::yes &&
                        segment_->negative().empty() && is_continuous();
  if (is_found) point_.on = on;
  return foretelling_.note(is_found);
}

/// Whether the segment in that position, or in one that its signs lead to, goes on from the states as they are. Few vectors show signs that are far from right: positions
/// that have them are left at once, as long as that leads to one that holds.
bool PartRun::follows_directly(const Position& candidate) {
  if (starting_) return false;
  Attempts& rejecting_early = rejecting_early_[passing_ >= 0 ? 1 : 0];
  segment_->reject_early(rejecting_early.is_due());
  const auto opened = open_segment(candidate);
  segment_->reject_early(false);
  const bool is_rejected = segment_->is_rejected();
  const bool is_found = opened == ExactSegment::Opened::yes && follows_by_signs(candidate);
  if (!is_rejected) return is_found;
  return rejecting_early.note(is_found) || (open_segment(candidate) == ExactSegment::Opened::yes && follows_by_signs(candidate));
}

/// The same, where the candidate's segment is open.
bool PartRun::follows_by_signs(const Position& candidate) {
  point_.on = candidate;
  return (segment_->negative().empty() || flip_negative(candidate, few_flips)) && is_continuous();
}

/// The position after an Euler step of length h, and its segment.
PartRun::Sought PartRun::seek_segment(const Beginning& beginning, Instant& instant, double h) {
  point_.on = beginning.on;
  instant.mode_change = beginning.instant.mode_change;
  trial_.solved = Solved::yes;
  if (!settle(h, instant, first_)) return Sought::not_found;
  const auto opened = open_segment(first_.on);
  if (opened == ExactSegment::Opened::singular) trial_.solved = Solved::singular;
  if (opened == ExactSegment::Opened::contradicted) trial_.solved = Solved::no_position;
  if (opened == ExactSegment::Opened::unresolved && may_jump_ && segment_->share() >= shortest_with_jumps)
    return jump_by_step(Point(first_), h);
  if (opened != ExactSegment::Opened::yes) return Sought::not_found;
  const Position on = point_.on = first_.on;
  const Point step = first_;
  segment_->unknowns(segment_->at(0.0), first_.z);
  const bool differs = difference(states_, first_.z) > tolerance::jump;
  if (differs && segment_->distance(point_.z, first_.z) > least_distance()) {
    if (!may_jump_) return Sought::not_found;
    if (!is_shared_by(step, h)) return Sought::not_found;
    instant.jump = true;
    return take_jump_of(step, h);
  }
  if (segment_->negative().empty()) return Sought::found;
  first_ = step;
  if (flip_negative(on, most_flips) && is_continuous()) return Sought::found;
  if (!differs || !may_jump_ || segment_->share() < shortest_with_jumps || open_segment(on) != ExactSegment::Opened::yes)
    return Sought::not_found;
  point_.on = on;
  segment_->unknowns(segment_->at(0.0), first_.z);
  return take_jump_of(step, h);
}

/// Whether the Euler step of length h that found the position jumps where the segment does. Where decays jump, it may go on from there, as such a step from the segment's start does.
bool PartRun::is_shared_by(const Point& step, double h) const {
  const std::vector<double> end = decays_jump_ ? segment_->euler_end(h) : first_.z;
  return segment_->distance(step.z, end) <= shared_jump * segment_->distance(point_.z, first_.z);
}

/// Ports whose guards depart downwards change sides, a few rounds: diodes first, as what a control reads where they are on a wrong side says nothing, and a switch that it would open,
/// a thyristor's latch, may stay open. Of controls those whose turn comes first. Where states jump what controls read is no more right: a current that a diode would take over is zero there.
bool PartRun::flip_negative(Position on, int rounds) {
  std::vector<Position> seen{on};
  for (int round = 0;; ++round) {
    if (segment_->negative().empty()) {
      point_.on = on;
      return true;
    }
    if (round == rounds) return false;
    const std::vector<std::size_t> next = first_negative();
    if (next.front() >= static_cast<std::size_t>(descriptor_.first_switch()) && !is_continuous()) return false;
    for (const std::size_t port : next) on[port] ^= 1;
    descriptor_.hold_blocked(on);
    if (std::find(seen.begin(), seen.end(), on) != seen.end()) return false;
    seen.push_back(on);
    if (open_segment(on) != ExactSegment::Opened::yes) return false;
  }
}

/// Of the ports whose guards depart downwards those that change sides next.
std::vector<std::size_t> PartRun::first_negative() const {
  const auto ports = descriptor_.first_switch();
  std::vector<std::size_t> next;
  std::vector<const WatchedControl*> controls;
  for (const int guard : segment_->negative()) {
    if (guard < ports)
      next.push_back(static_cast<std::size_t>(guard));
    else
      controls.push_back(&controls_[static_cast<std::size_t>(guard - ports)]);
  }
  if (!next.empty()) return next;
  keep_first_turn(controls);
  for (const WatchedControl* control : controls) next.push_back(control->port);
  return next;
}

/// Ports that are free to conduct do, as in the exact engine, where they then carry something and nothing speaks against it: parallel diodes share their current.
/// Diodes of a part at rest, as those far up a multiplier that has just started, stay off: on, they would all be in dispute at each of its events. False: failed.
bool PartRun::share_freely() {
  const Position on = point_.on;
  Position shared = on;
  for (const int port : segment_->free_ports()) shared[static_cast<std::size_t>(port)] = 1;
  descriptor_.hold_blocked(shared);
  if (shared == on || !factors_.may_share(on, shared)) return true;
  std::string flows(on.begin(), on.end());  // what others that carry nothing could share, they may carry the next time
  for (const int port : segment_->idle_ports()) flows[static_cast<std::size_t>(port)] = idle_mark;
  if (unshared_.contains(flows)) return true;
  const std::vector<int> free = segment_->free_ports();
  const bool is_open = open_segment(shared) == ExactSegment::Opened::yes && is_continuous();
  const std::vector<int>& negative = segment_->negative();
  const bool fits = is_open && negative.empty(),
             none_fits = is_open && std::includes(negative.begin(), negative.end(), free.begin(), free.end());
  const std::vector<int>& idle = segment_->idle_ports();
  if (fits && !std::includes(idle.begin(), idle.end(), free.begin(), free.end())) {
    point_.on = shared;
    return true;
  }
  if (fits || none_fits) unshared_.insert(std::move(flows));
  return opens_again();
}

/// The segment of the position that was found, after those of others: what its vectors have been there makes it another one, whose signs may differ.
bool PartRun::opens_again() {
  return open_segment(point_.on) == ExactSegment::Opened::yes && segment_->negative().empty() && is_continuous();
}

/// Where the rows of the segment have lost digits, it is made of solutions that are corrected, if that leaves its signs as they are. False: failed.
bool PartRun::correct_rows() {
  if (segment_->is_refined() || !certificate_.looks_next()) return true;
  const Point first = point_of_segment(0.0, point_.time, true);
  if (!(certificate_.row_residual(first, {.length = segment_->length()}) > tolerance::doubtful_rows)) return true;
  segment_->refine(true);
  if (open_segment(point_.on) == ExactSegment::Opened::yes && segment_->negative().empty()) {
    segment_->refine_position();
    return true;
  }
  segment_->refine(false);
  return opens_again();
}

/// Back to where a search began: a jump that is taken moves the point, and is none where nothing follows it.
void PartRun::stand(const Standing& at) {
  point_.z = at.z;
  start_memory_ = at.memory;
  states_ = at.states;
}

bool PartRun::find_segment(const Beginning& beginning, Instant& instant) {
  const Position ahead = std::exchange(position_ahead_, Position{});
  bool found = false;
  const Standing before{point_.z, start_memory_, states_};
  const bool has_moved = point_.time > segment_->start();  // else guards at rounding could pass each other for ever
  for (const Relaxation& relaxation : relaxations) {
    if (!has_moved && relaxation.takes_positive && relaxation.ways == Ways::directly) continue;
    if (passing_ < 0 && relaxation.length < 1.0 && relaxation.ways == Ways::directly) continue;
    const bool takes_steps = relaxation.ways == Ways::by_steps || relaxation.ways == Ways::all;
    segment_->relax(relaxation.factor, takes_steps || !has_moved ? relaxation.factor * wide_noise : 1.0, relaxation.takes_positive);
    segment_->shorten(relaxation.length);
    segment_->refine(relaxation.refines);
    may_jump_ = relaxation.jumps;
    decays_jump_ = relaxation.decays_jump;
    given_jumps_ = relaxation.given_jumps;
    stand(before);
    jump_steps_ = {};
    jump_impulses_.clear();
    jump_terms_.clear();
    jumps_taken_.clear();
    const Position& candidate = ahead.empty() ? beginning.on : ahead;
    const Ways ways = relaxation.ways;
    found = ways == Ways::directly_or_by_ties && follows_as_foretold(candidate);
    found = found || (ways != Ways::by_steps && follows_directly(candidate));
    if (!found && (ways == Ways::directly_or_by_ties || ways == Ways::all)) found = follows_by_ties(beginning, candidate);
    if (!found && (ways == Ways::by_steps || ways == Ways::all)) found = find_after_steps(beginning, instant);
    if (found && relaxation.refines) segment_->refine_position();
    found = found && share_freely() && correct_rows();
    if (found || !failure_.id.empty()) break;
  }
  segment_->relax(1.0, 1.0, false);
  segment_->shorten(1.0);
  segment_->refine(false);
  if (found || !failure_.id.empty()) return found;
  if (trial_.solved != Solved::yes) return fail_step(trial_.solved, 0.0);
  fail(Outcome::no_solution, "E-no-solution",
       fmt::format("no segment continues at t = {} s: no position was found whose signs and derivatives agree; "
                   "try --engine sparse",
                   instant.time),
       {});
  return false;
}

/// Where a port passes zero and nothing else happens, no state jumps, and the others stay on their sides but for those at zero: these settle among themselves in a step, if the signs of derivatives
/// confirm what it finds.
bool PartRun::follows_by_ties(const Beginning& beginning, Position candidate) {
  const bool is_passage = passing_ >= 0 && passing_ < descriptor_.first_switch();
  if (starting_ || !is_passage || beginning.instant.source_edge || beginning.instant.mode_change) return false;
  std::vector<double> w, zeta;
  sources_.evaluate(point_.time, w);
  ties_->find(point_.z, w, candidate, passing_);
  sources_.states(point_.time, zeta);
  if (!ties_->decide(point_.z, zeta, euler_length(beginning), candidate)) return false;
  if (open_segment(candidate) != ExactSegment::Opened::yes || !segment_->negative().empty() || !is_continuous()) return false;
  point_.on = candidate;
  return true;
}

double PartRun::euler_length(const Beginning& beginning) const {
  const double usual = segment_->usual_length(beginning.on, std::max(room(), break_tolerance_));
  const double wanted = std::min(euler_share * usual, euler_room * std::max(room(), break_tolerance_));
  return std::exp2(2.0 * std::floor(0.5 * std::log2(wanted)));
}

/// The position after Euler steps of several lengths. A jump that asks ports for impulses backwards is refused, unless steps of all lengths find its position: the shortest would show such an
/// impulse, so that what moves is over soon, but finite (a current that leaks take over).
PartRun::Sought PartRun::seek_by_steps(const Beginning& beginning, Instant& instant, double h) {
  refused_jumps_.clear();
  const Standing before{point_.z, start_memory_, states_};
  for (const double scale : euler_scales) {
    const Sought sought = seek_segment(beginning, instant, scale * h);
    if (!failure_.id.empty() || sought != Sought::not_found) return sought;
    stand(before);
  }
  const auto is_first = [&](const Position& on) { return on == refused_jumps_.front(); };
  if (refused_jumps_.size() < euler_scales.size() || !std::all_of(refused_jumps_.begin(), refused_jumps_.end(), is_first))
    return Sought::not_found;
  trusts_jumps_ = true;
  const Sought sought = seek_segment(beginning, instant, euler_scales.back() * h);
  trusts_jumps_ = false;
  return sought;
}

bool PartRun::find_after_steps(const Beginning& beginning, Instant& instant) {
  const double h = euler_length(beginning);
  Beginning from = beginning;
  for (int jumps = 0; jumps < most_jumps; ++jumps) {
    const Sought sought = seek_by_steps(from, instant, h);
    if (!failure_.id.empty()) return false;
    if (sought == Sought::found) return true;
    if (sought == Sought::not_found) return false;
    from.on = point_.on;
    from.instant = instant;
  }
  return false;
}

}  // namespace pwlsim::engine::sparse
