#include "engine/sparse/block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

namespace pwlsim::engine::sparse {

namespace {

constexpr double most_steps_of_run = 1.0 / 64.0;     ///< the largest step, of the run
constexpr double most_steps_of_period = 1.0 / 16.0;  ///< and of a sinusoid's period
/// Rows lie on the parabola through a step's stages, which leaves a sinusoid by this times (ωh)³: max |t (t − 2d) (t − 1)|/6 over the step.
constexpr double parabola_error = 0.0105;
constexpr int first_level = 6;
/// Growth waits until the error of the doubled step is this part of the tolerance.
constexpr double growth_share = 0.5;
constexpr double least_improvement = 1e-3;  ///< an error below this part of the tolerance stays in
constexpr double merge_fraction = 1e-14;    ///< of the run: instants closer than this are one
constexpr double break_fraction = 1e-11;    ///< and breakpoints of sources closer than this
/// A step may reach so many times beyond where it is cut.
constexpr double overshoot = 8.0;
constexpr double whole = 1.0 - 1e-9;  ///< of a step: nothing to cut
/// What changes of sides may do to a saved signal, in tolerances, before they are located.
constexpr double signal_tolerances = 10.0;
constexpr std::size_t many_crossings = 3;  ///< in a step: not one by one, if that is within the tolerance
constexpr int absorbed_levels = 6;         ///< the Euler step behind such a step is so much shorter
constexpr int longest_pause = 63;          ///< of such steps between two attempts
constexpr std::size_t most_positions = 1u << 20;
/// So many steps within that part of the run, and residuals of the certificate of that size (and of so many tolerances): they lead nowhere.
constexpr std::uint64_t steps_between_looks = 50'000;
constexpr double short_stretch = 2.5e-4, hopeless_residual = 1e-3, hopeless_tolerances = 10.0;
/// Wrong altogether, or in Kirchhoff's laws, which solutions keep to rounding: then it need not get worse to be given up.
constexpr double slow_stretch = 1e-2, senseless_residual = 0.5, broken_laws = 1e-6;
/// So many of them that stand at a cliff: the next longer one is so much worse, as no power of the step makes it, for want of a position. Unless events
/// come of it.
constexpr double cliff = 1e6;
constexpr std::uint64_t most_cliffs = steps_between_looks / 4, few_events = steps_between_looks / 500;
/// Without events, in an active network, at so many looks in a row: what is left would take a million times that many steps. A ring may die down meanwhile.
constexpr double hopeless_stretch = 1e-6;
constexpr int most_stuck_looks = 20;
/// Nearly every second one leads to a passage after which every port stays on its side, or, in a passive network too, stands at a cliff, between so many
/// looks in a row.
constexpr std::uint64_t many_idle = steps_between_looks * 2 / 5;
constexpr int most_idle_looks = 2;
constexpr double idle_stretch = 0.05;
/// So many passages in a row after which every port stays on its side: with such residuals it should not have stayed there.
constexpr int most_idle_passages = 2'000;

/// Of a sinusoid of that period, with errors of its rows within the tolerance.
double longest_step(double period, double reltol) {
  return period * std::min(most_steps_of_period, std::cbrt(reltol / parabola_error) / (2.0 * std::numbers::pi));
}

double residual(const Certificate& certificate) { return std::max(certificate.complementarity, certificate.kcl_kvl); }

}  // namespace

Block::Block(const Part& part, const Request& request, double reltol)
    : part_(part),
      request_(request),
      reltol_(reltol),
      descriptor_(part.descriptor),
      factors_(part.island.network, descriptor_, reltol),
      ports_(descriptor_, factors_, largest_held_voltage(part.island.network)),
      sources_(part.island.network),
      stepper_(descriptor_, ports_, sources_),
      scale_(descriptor_, largest_held_voltage(part.island.network)),
      controls_(controls_of(part.island.network, descriptor_)),
      gates_(part.gates),
      certificate_(descriptor_) {
  for (const Gate& gate : gates_) std::erase_if(controls_, [&](const Control& control) { return control.port == gate.port(); });
  for (const auto& signal : part.island.network.signals) {
    signals_.push_back(descriptor_.form(signal.form));
    signals_read_sources_ |= !signals_.back().w.empty();
  }
  signal_scale_.assign(signals_.size(), 0.0);
  signals_before_.assign(signals_.size(), 0.0);
  h_max_ = std::min(most_steps_of_run * request.stop, longest_step(sources_.shortest_period(), reltol));
  level_ = first_level;
  tolerance_ = merge_fraction * request.stop;
  break_tolerance_ = break_fraction * request.stop;
  passive_ = descriptor_.passive();
}

void Block::signals(double time, double* values) {
  const auto weights = stretch_.weights(time);
  if (signals_read_sources_) sources_.evaluate(time, w_);
  for (std::size_t i = 0; i < signals_.size(); ++i) values[i] = Form::sum(signals_[i].w, w_.data(), stretch_.value(signals_[i], weights));
}

void Block::signals(double time, std::span<const int> numbers, double* values) {
  const auto weights = stretch_.weights(time);
  if (signals_read_sources_) sources_.evaluate(time, w_);
  for (const int number : numbers) {
    const Form& form = signals_[static_cast<std::size_t>(number)];
    *values++ = Form::sum(form.w, w_.data(), stretch_.value(form, weights));
  }
}

double Block::signal_size(int number) const { return signals_[static_cast<std::size_t>(number)].size(point_.z.data(), point_.w.data()); }

bool Block::advance() {
  instant_.reset();
  impulses_.clear();
  if (restart_due_ || next_break() <= point_.time + break_tolerance_) return restart() && look_back();
  if (point_.time >= request_.stop - tolerance_) {
    finished_ = true;
    return true;
  }
  return step() && look_back();
}

/// Where no solution continues, steps may get ever shorter from one wrong position to the next, or ports leave their sides and find no others: an active
/// network need not have one. False: given up.
bool Block::look_back() {
  if (steps_ - looked_after_ >= steps_between_looks) {
    looked_after_ = steps_;
    const double stretch = point_.time - std::exchange(looked_at_, point_.time);
    const std::string why = why_nowhere(stretch);
    if (!why.empty())
      return give_up(fmt::format("steps get too short before t = {} s ({} of them within {:.3g} s), and {}", point_.time,
                                 steps_between_looks, stretch, why));
  }
  if (idle_passages_ >= most_idle_passages) {
    idle_passages_ = 0;
    if (const double worst = residual(certificate_.check()); worst >= hopeless())
      return give_up(
          fmt::format("ports leave their sides before t = {} s and find no others ({} times), and violate the circuit's laws by {:.1e}",
                      point_.time, most_idle_passages, worst));
  }
  return true;
}

/// What is wrong with the last steps, if they took no longer than that and lead nowhere.
std::string Block::why_nowhere(double stretch) {
  const Certificate certificate = certificate_.check();
  const double worst = residual(certificate);
  const bool is_worse = worst > std::exchange(worst_before_, worst);
  const bool is_senseless = worst >= senseless_residual || certificate.kcl_kvl >= broken_laws;
  const std::uint64_t events = events_ - std::exchange(events_before_, events_);
  const std::uint64_t idle = std::exchange(idle_between_looks_, 0);
  idle_looks_ = idle > many_idle ? idle_looks_ + 1 : 0;
  const bool is_quiet = events < few_events;
  const std::uint64_t cliffs = std::exchange(cliffs_, 0);
  cliff_looks_ = cliffs > many_idle ? cliff_looks_ + 1 : 0;
  const bool is_blocked = is_quiet && (passive_ ? cliff_looks_ >= most_idle_looks : cliffs > most_cliffs);
  stuck_looks_ = is_quiet && !passive_ && stretch <= hopeless_stretch * request_.stop ? stuck_looks_ + 1 : 0;
  if (stuck_looks_ >= most_stuck_looks)
    return fmt::format("what is left would take {:.0e} of them",
                       static_cast<double>(steps_between_looks) * (request_.stop - point_.time) / stretch);
  if (is_quiet && idle_looks_ >= most_idle_looks && stretch <= idle_stretch * request_.stop)
    return fmt::format("at {} of them ports leave their sides and find no others", idle);
  if (stretch > (is_senseless || is_blocked ? slow_stretch : short_stretch) * request_.stop) return "";
  if (is_senseless || (is_worse && worst >= hopeless())) return fmt::format("violate the circuit's laws by {:.1e}", worst);
  return is_blocked ? "longer ones find no position, or one from another side" : "";
}

double Block::hopeless() const { return std::max(hopeless_residual, hopeless_tolerances * reltol_); }

bool Block::give_up(const std::string& what) {
  fail(Outcome::no_solution, "E-step", what + ": a solution may not exist; try --engine exact, which examines it", {});
  return false;
}

/// Time to the next breakpoint or the end.
double Block::remaining() const { return std::min(next_break(), request_.stop) - point_.time; }

int Block::step_level() const {
  int level = level_;
  while (level < last_level && ladder(level) > overshoot * remaining()) ++level;
  return level;
}

bool Block::step() {
  rejected_ = false;
  double rejected_error = 0.0;
  while (true) {
    const double h = ladder(step_level());
    stepper_.tr_bdf2(point_, h, scale_, trial_);
    if (trial_.solved == Solved::singular) return fail_step(trial_.solved, trial_.error);
    if (trial_.error > reltol_) {  // or the position contradicts the network further on
      rejected_error = trial_.error;
      if (!reduce(h, trial_.error)) return fail_step(trial_.solved, trial_.error);
      continue;
    }
    if (rejected_error > cliff * trial_.error) ++cliffs_;
    if (passive_ && trial_.error > least_improvement * reltol_) {
      const Solved solved = stepper_.improve(h, trial_);
      if (solved != Solved::yes) return fail_step(solved, trial_.error);
    }
    const double reach = std::min(1.0, remaining() / h);
    const std::vector<Crossing> list = crossings(trial_, reach);
    if (list.empty()) {
      accept(trial_, reach);
      if (reach >= whole) control_size(trial_.error);
      return true;
    }
    if (list.size() >= many_crossings && reach >= whole && !request_.events && absorbs(h)) return true;
    return cut(h, list, reach);
  }
}

/// Tried less and less often where it fails.
bool Block::absorbs(double h) {
  if (absorb_wait_ > 0) {
    --absorb_wait_;
    return false;
  }
  const bool done = absorb(h);
  absorb_pause_ = done ? 0 : std::min(2 * absorb_pause_ + 1, longest_pause);
  absorb_wait_ = absorb_pause_;
  return done;
}

/// A step in which many ports change sides, none of them located. False: they matter.
bool Block::absorb(double h) {
  stepper_.sdirk2(point_, h, scale_, free_);
  if (free_.solved != Solved::yes || free_.error > reltol_ || matters(free_.end, trial_.end)) return false;
  for (std::size_t i = 0; i < controls_.size(); ++i)
    if (margin(i, true, free_.end) < 0.0) return false;
  Point next;
  if (stepper_.euler(free_.end, diagonal * ladder(std::min(level_ + absorbed_levels, last_level)), next) != Solved::yes) return false;
  if (next.on != free_.end.on || next.time > point_.time + remaining()) return false;
  certificate_.add_point(free_.end, ports_);
  stretch_.set(point_, free_.stage, next);
  settle_in(next);
  ++events_;
  control_size(free_.error);
  return true;
}

/// Whether two ends of a step differ in a saved signal by more than rows are good for.
bool Block::matters(const Point& a, const Point& b) const {
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    const double x = signals_[i].value(a.z.data(), a.w.data());
    const double y = signals_[i].value(b.z.data(), b.w.data());
    if (std::abs(x - y) > signal_tolerances * reltol_ * std::max({signal_scale_[i], std::abs(x), std::abs(y)})) return true;
  }
  return false;
}

/// The part of a step up to the fraction `reach`.
void Block::accept(const Trial& trial, double reach) {
  stretch_.set(point_, trial.stage, trial.end);
  Point next = trial.end;
  if (reach < whole) {
    next.time = point_.time + reach * (trial.end.time - point_.time);
    const double limit = point_.time + remaining();
    if (std::abs(next.time - limit) <= break_tolerance_) next.time = limit;
    stretch_.interpolate(stretch_.weights(next.time), next.z);
    sources_.evaluate(next.time, next.w);
  }
  certificate_.add_step(point_, trial, next, ports_);
  settle_in(next);
}

/// Goes on from a point.
void Block::settle_in(Point& next) {
  std::swap(point_, next);
  scale_.note(point_.z);
  ports_.note_scale(point_.z, point_.w);
  for (Control& control : controls_)
    control.largest = std::max(control.largest, std::abs(control.value.value(point_.z.data(), point_.w.data())));
  for (std::size_t i = 0; i < signals_.size(); ++i)
    signal_scale_[i] = std::max(signal_scale_[i], std::abs(signals_[i].value(point_.z.data(), point_.w.data())));
  ++steps_;
  if (positions_.size() < most_positions) positions_.insert(std::hash<std::string_view>()({point_.on.data(), point_.on.size()}));
}

void Block::control_size(double error) {
  if (rejected_) return;
  const double eighth = growth_share * reltol_ / 8.0;
  if (level_ > 0 && error < eighth) --level_;
  if (level_ > 0 && error < eighth / 64.0) --level_;
}

/// Down the ladder from a step of h by what its error asks for. False: the end of the ladder.
bool Block::reduce(double h, double error) {
  rejected_ = true;
  const double factor = error < model::forever ? std::cbrt(0.5 * reltol_ / error) : 0.25;
  while (ladder(level_) >= h) ++level_;
  while (ladder(level_) > 1.4 * factor * h) ++level_;
  return level_ <= last_level && ladder(level_) > tolerance_;
}

std::vector<std::string> Block::names(const std::vector<int>& ports) const {
  constexpr std::size_t most_names = 12;
  std::vector<std::string> result;
  for (const int i : ports)
    if (result.size() < most_names) result.push_back(descriptor_.ports()[static_cast<std::size_t>(i)].name);
  return result;
}

void Block::fail(Outcome outcome, std::string id, std::string text, std::vector<std::string> elements) {
  failure_.outcome = outcome;
  failure_.id = std::move(id);
  failure_.message = std::move(text);
  failure_.elements = std::move(elements);
}

bool Block::fail_step(Solved solved, double error) {
  if (!failure_.id.empty()) return false;
  const double time = point_.time;
  if (solved == Solved::singular) {
    const int unknown = factors_.singular_unknown();
    const std::string what = unknown >= 0 ? descriptor_.unknown_name(unknown) : "some unknown";
    if (factors_.out_of_memory()) {
      fail(Outcome::no_solution, "E-out-of-memory", fmt::format("no memory is left for the factors at t = {} s", time), {});
    } else {
      fail(Outcome::no_solution, "E-singular",
           fmt::format("the equations leave {} open at t = {} s; try a resistor to ground, or one in its loop of sources", what, time),
           {what});
    }
  } else if (solved == Solved::no_position) {
    const auto elements = names(ports_.disputed());
    fail(Outcome::no_solution, "E-no-solution",
         fmt::format("no solution continues at t = {} s: no position of {} satisfies the circuit; try a small resistor in their loops",
                     time, fmt::join(elements, ", ")),
         elements);
  } else {
    fail(Outcome::no_solution, "E-step",
         fmt::format("no step from t = {} s meets the tolerance: its error is {:.1e} at the smallest step; try a larger --reltol", time,
                     error),
         {});
  }
  return false;
}

void Block::add_statistics(Statistics& s) const {
  s.states += descriptor_.states().size();
  s.ports += static_cast<std::uint64_t>(descriptor_.first_switch());
  s.switches += descriptor_.ports().size() - static_cast<std::uint64_t>(descriptor_.first_switch());
  s.modes_visited += positions_.size();
  s.events += events_;
  s.jumps += jumps_;
  s.lcp_pivots += ports_.pivots();
  s.klu_factorizations += factors_.counts().factorizations + factors_.counts().refactorizations;
  s.klu_solves += factors_.counts().solves;
  s.steps += steps_;
}

}  // namespace pwlsim::engine::sparse
