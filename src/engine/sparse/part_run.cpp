#include "engine/sparse/part_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "base/arithmetic.hpp"
#include "engine/sparse/fastest.hpp"
#include "engine/sparse/tolerances.hpp"

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
/// A step may reach so many times beyond where it is cut.
constexpr double overshoot = 8.0;
constexpr int deep_level = 20;             ///< halvings of the largest step from which on they are short
constexpr int longest_standing = 1 << 16;  ///< accepted steps there between two attempts at longer ones
/// What changes of sides may do to a saved signal, in tolerances, before they are located.
constexpr double signal_tolerances = 10.0;
constexpr std::size_t many_crossings = 3;  ///< in a step: not one by one, if that is within the tolerance
constexpr int absorbed_levels = 6;         ///< the Euler step behind such a step is so much shorter
/// A step of this part of √reltol of the fastest time constant moves nothing by the tolerance, once what it moves is drawn back.
constexpr double shortest_share = 0.25;
constexpr std::size_t most_positions = 1u << 20;

/// Of a sinusoid of that period, with errors of its rows within the tolerance.
double longest_step(double period, double reltol) {
  return period * std::min(most_steps_of_period, std::cbrt(reltol / parabola_error) / (2.0 * std::numbers::pi));
}

double scale_of_sources(const model::Network& network, const Descriptor& descriptor, PartRun::Method method, double stop) {
  const double voltage = largest_held_voltage(network, stop);
  return method == PartRun::Method::steps ? voltage : std::max(voltage, descriptor.r0() * largest_injected_current(network, stop));
}

}  // namespace

PartRun::PartRun(const Part& part, const Request& request, double reltol, Method method)
    : part_(part),
      request_(request),
      reltol_(reltol),
      descriptor_(part.descriptor),
      source_scale_(scale_of_sources(part.island.network, part.descriptor, method, request.stop)),
      factors_(part.island.network, descriptor_, reltol),
      ports_(descriptor_, factors_, source_scale_),
      sources_(part.island.network),
      stepper_(descriptor_, ports_, sources_),
      scale_(descriptor_, source_scale_, method == Method::steps),
      controls_(part.controls),
      gates_(part.gates),
      thresholds_(part.watched, request.stop),
      certificate_(descriptor_),
      passive_(descriptor_.passive()),
      stall_(passive_, request.stop, reltol) {
  for (const Gate& gate : gates_) std::erase_if(controls_, [&](const WatchedControl& control) { return control.port == gate.port(); });
  for (const auto& signal : part.island.network.signals) {
    signals_.push_back(descriptor_.form(signal.form));
    signals_read_sources_ |= !signals_.back().w.empty();
  }
  if (method == Method::segments) {
    segment_ = std::make_unique<ExactSegment>(descriptor_, sources_, controls_, reltol, request.stop);
    segment_->heed(request.interrupt);
    segment_->count_by(scale_);
    ties_ = std::make_unique<TieSelector>(descriptor_, factors_, sources_.exosystem());
    if (passive_) open_signals_ = std::make_unique<OpenSignals>(descriptor_);
    if (passive_) forecast_ = std::make_unique<Forecast>(descriptor_, factors_, sources_);
    factors_.keep_digits();
    ports_.judge_by_rows();
  }
  signal_scale_.assign(signals_.size(), 0.0);
  signals_before_.assign(signals_.size(), 0.0);
  h_max_ = std::min(most_steps_of_run * request.stop, longest_step(sources_.shortest_period(), reltol));
  level_ = first_level;
  tolerance_ = tolerance::merge * request.stop;
  break_tolerance_ =
      (method == Method::segments ? tolerance::merge : tolerance::same_break) * request.stop;  // only steps have a shortest length
  shortest_ = std::max(shortest_share * std::sqrt(reltol) * fastest_time(part.island.network), tolerance::shortest_step * request.stop);
}

void PartRun::signals(double time, double* values) {
  if (segment_ && begins_at(time)) {
    const std::vector<double>& start = signals_at_start();
    std::copy(start.begin(), start.end(), values);
    return;
  }
  if (segment_) {
    const std::vector<double>& y = segment_->at(time - segment_->start());
    if (signals_read_sources_) sources_.evaluate(time, w_);
    for (std::size_t i = 0; i < signals_.size(); ++i) values[i] = Form::sum(signals_[i].w, w_.data(), segment_->signal(i, y));
    return;
  }
  const auto weights = stretch_.weights(time);
  if (signals_read_sources_) sources_.evaluate(time, w_);
  for (std::size_t i = 0; i < signals_.size(); ++i) values[i] = Form::sum(signals_[i].w, w_.data(), stretch_.value(signals_[i], weights));
}

void PartRun::signals(double time, std::span<const int> numbers, double* values) {
  if (segment_) {
    const std::vector<double>& y = segment_->at(time - segment_->start());
    if (signals_read_sources_) sources_.evaluate(time, w_);
    for (const int number : numbers) {
      const auto i = static_cast<std::size_t>(number);
      *values++ = Form::sum(signals_[i].w, w_.data(), segment_->signal(i, y));
    }
    return;
  }
  const auto weights = stretch_.weights(time);
  if (signals_read_sources_) sources_.evaluate(time, w_);
  for (const int number : numbers) {
    const Form& form = signals_[static_cast<std::size_t>(number)];
    *values++ = Form::sum(form.w, w_.data(), stretch_.value(form, weights));
  }
}

/// A segment knows all voltages to a part of the largest of them so far, and all currents to a part of the largest.
double PartRun::signal_size(int number) const {
  const Form& form = signals_[static_cast<std::size_t>(number)];
  if (!segment_) return form.size(point_.z.data(), point_.w.data());
  double size = std::abs(form.constant) + Form::size_of(form.w, point_.w.data());
  for (const Form::IndexedTerm& part : form.z)
    size += std::abs(part.coefficient) * (part.index < descriptor_.nodes() ? largest_voltage_ : largest_current_);
  return size;
}

bool PartRun::advance() {
  instant_.reset();
  impulses_.clear();
  if (stops_before_end_ && point_.time >= request_.stop - tolerance_) {
    finished_ = true;
    return true;
  }
  const bool starts_anew = restart_due_ || next_break() <= point_.time + break_tolerance_;
  if (starts_anew) return segment_ ? begin_segment() : restart() && look_back();
  if (point_.time >= request_.stop - tolerance_) {
    finished_ = true;
    return true;
  }
  return segment_ ? follow_segment() : step() && look_back();
}

/// False: given up, since nothing comes of the steps.
bool PartRun::look_back() {
  const StallWatch::Progress now{point_.time, steps_, events_};
  if (!stall_.is_due(now)) return true;
  const std::string why = stall_.look(certificate_.check(), now);
  return why.empty() || give_up(why);
}

bool PartRun::give_up(const std::string& what) {
  fail(Outcome::no_solution, "E-step", what + ": a solution may not exist; try --engine exact, which checks it", {});
  return false;
}

/// Time to the next breakpoint or the end.
double PartRun::remaining() const { return std::min(next_break(), request_.stop) - point_.time; }

int PartRun::step_level() const {
  int level = level_;
  while (level < last_level && ladder(level) > overshoot * remaining()) ++level;
  return level;
}

bool PartRun::step() {
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
    stall_.note_errors(trial_.error, rejected_error);
    if (passive_ && trial_.error > least_improvement * reltol_) {
      const Solved solved = stepper_.improve(h, trial_);
      if (solved != Solved::yes) return fail_step(solved, trial_.error);
    }
    const double reach = std::min(1.0, remaining() / h);
    const std::vector<Crossing> list = crossings(h, reach);
    if (list.empty()) {
      accept(trial_, reach);
      if (reach >= tolerance::whole_step) control_size(trial_.error);
      return true;
    }
    if (list.size() >= many_crossings && reach >= tolerance::whole_step && !request_.events && absorbs(h)) return true;
    return cut(h, list, reach);
  }
}

/// Tried less and less often where it fails.
bool PartRun::absorbs(double h) { return absorbing_.is_due() && absorbing_.note(absorb(h)); }

/// A step in which many ports change sides, none of them located. False: they matter.
bool PartRun::absorb(double h) {
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
bool PartRun::matters(const Point& a, const Point& b) const {
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    const double x = signals_[i].value(a.z.data(), a.w.data());
    const double y = signals_[i].value(b.z.data(), b.w.data());
    if (std::abs(x - y) > signal_tolerances * reltol_ * std::max({signal_scale_[i], std::abs(x), std::abs(y)})) return true;
  }
  return false;
}

/// The part of a step up to the fraction `reach`.
void PartRun::accept(const Trial& trial, double reach) {
  stretch_.set(point_, trial.stage, trial.end);
  Point next = trial.end;
  if (reach < tolerance::whole_step) {
    next.time = point_.time + reach * (trial.end.time - point_.time);
    const double limit = point_.time + remaining();
    if (std::abs(next.time - limit) <= break_tolerance_) next.time = limit;
    stretch_.interpolate(Stretch::weights_within(reach), next.z);
    sources_.evaluate(next.time, next.w);
  }
  certificate_.add_step(point_, trial, next, ports_);
  if (standing_ + 1 >= standing_limit_) {
    descriptor_.measure_states(point_.z.data(), states_);
    moved_ = difference(states_, next.z);
  }
  settle_in(next);
}

/// Goes on from a point.
void PartRun::settle_in(Point& next) {
  std::swap(point_, next);
  scale_.note(point_.z);
  ports_.note_scale(point_.z, point_.w);
  for (WatchedControl& control : controls_)
    control.largest = std::max(control.largest, std::abs(control.value.value(point_.z.data(), point_.w.data())));
  if (thresholds_.asks_anything()) watch_controls();
  for (std::size_t i = 0; i < signals_.size(); ++i)
    signal_scale_[i] = std::max(signal_scale_[i], std::abs(signals_[i].value(point_.z.data(), point_.w.data())));
  if (segment_ && request_.probes.sink != nullptr) note_largest_unknowns();
  ++steps_;
  if (positions_.size() < most_positions) positions_.insert(std::hash<std::string_view>()({point_.on.data(), point_.on.size()}));
}

void PartRun::note_largest_unknowns() {
  const std::span<const double> all(point_.z);
  const auto nodes = static_cast<std::size_t>(descriptor_.nodes());
  largest_voltage_ = std::max(largest_voltage_, largest(all.first(nodes)));
  largest_current_ = std::max(largest_current_, largest(all.subspan(nodes)));
}

void PartRun::control_size(double error) {
  if (rejected_) {
    standing_ = 0;
    return;
  }
  const double eighth = growth_share * reltol_ / 8.0;
  if (level_ > 0 && error < eighth) {
    standing_ = 0;
    --level_;
    if (level_ > 0 && error < eighth / 64.0) --level_;
    return;
  }
  // In steps this short they may follow a ring that is made of nothing but rounding, or of nothing that counts: a far longer one damps it.
  if (level_ < deep_level || ++standing_ < standing_limit_) return;
  standing_ = 0;
  standing_limit_ = std::min(2 * standing_limit_, longest_standing);
  level_ = first_level;
  damped_ = std::max(damped_, moved_);
}

/// Down the ladder from a step of h by what its error asks for. False: the end of the ladder.
bool PartRun::reduce(double h, double error) {
  rejected_ = true;
  const double factor = error < model::forever ? std::cbrt(0.5 * reltol_ / error) : 0.25;
  while (ladder(level_) >= h) ++level_;
  while (ladder(level_) > 1.4 * factor * h) ++level_;
  return level_ <= last_level;
}

std::vector<std::string> PartRun::names(const std::vector<int>& ports) const {
  constexpr std::size_t most_names = 12;
  std::vector<std::string> result;
  for (const int i : ports)
    if (result.size() < most_names) result.push_back(descriptor_.ports()[static_cast<std::size_t>(i)].name);
  return result;
}

bool PartRun::fail_step(Solved solved, double error) {
  if (!failure_.id.empty()) return false;
  const double time = point_.time;
  if (solved == Solved::singular) {
    const int unknown = factors_.singular_unknown();
    const std::string what = unknown >= 0 ? descriptor_.unknown_name(unknown) : "some unknown";
    if (factors_.out_of_memory()) {
      fail(Outcome::no_solution, "E-out-of-memory", fmt::format("no memory is left for the factors at t = {} s", time), {});
    } else {
      fail(
          Outcome::no_solution, "E-singular",
          fmt::format("the equations do not determine {} at t = {} s; try a resistor to ground, or one in its loop of sources", what, time),
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

void PartRun::add_statistics(Statistics& s) const {
  s.states += descriptor_.states().size();
  s.ports += static_cast<std::uint64_t>(descriptor_.first_switch());
  s.switches += descriptor_.ports().size() - static_cast<std::uint64_t>(descriptor_.first_switch());
  if (!descriptor_.ports().empty()) s.modes_visited += positions_.size();  // others have but one
  s.events += events_;
  s.jumps += jumps_;
  s.lcp_pivots += ports_.pivots() + (ties_ ? ties_->pivots() : 0);
  const auto add = [&s](const linalg::KluOrdering::Counts& counts) {
    s.klu_factorizations += counts.factorizations + counts.refactorizations + counts.partial_factorizations;
    s.klu_solves += counts.solves;
  };
  add(factors_.counts());
  if (start_unknowns_) add(start_unknowns_->counts());
  s.steps += steps_;
}

}  // namespace pwlsim::engine::sparse
