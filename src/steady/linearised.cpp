#include "steady/linearised.hpp"
#include "steady/tolerances.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace pwlsim::steady {
namespace {

using engine::Cause;
using engine::Change;
using model::Mode;
using model::System;

Vector outputs_of(const Mode& mode, const std::vector<double>& y) {
  Vector outputs(mode.outputs.rows());
  linalg::multiply(mode.outputs, y.data(), outputs.data());
  return outputs;
}

/// An instant of others, or a corner of a source that the island does not read.
bool is_nothing(const Change& change) {
  return change.before == change.after && change.y_before == change.y_after &&
         std::none_of(change.by_way_of.begin(), change.by_way_of.end(), [&](const Mode* mode) { return mode != change.after; });
}

/// How a control that sources alone decide stands just before an instant.
struct ClockValue {
  double value = 0.0, slope = 0.0, size = 0.0;
};

ClockValue clock_value(const System& system, const model::Control& control, double time) {
  const model::Exosystem& sources = *system.exosystem;
  ClockValue at;
  if (sources.constant() >= 0) at.value = control.value.state[system.n + sources.constant()];
  at.size = std::abs(at.value);
  for (const auto& track : sources.tracks()) {
    const double gain = control.value.state[system.n + sources.blocks()[static_cast<std::size_t>(track.block)].first];
    if (gain == 0.0) continue;
    const model::Track::Cursor cursor = track.track.before(time);
    at.value += gain * cursor.at(time);
    at.slope += gain * cursor.slope;
    at.size += std::abs(gain) * cursor.size_at(time);
  }
  return at;
}

/// Whether a guard is at zero within this time, and moves.
bool is_passed(const Change& change, int row, double near) {
  const Mode& mode = *change.before;
  Vector rate(mode.ny);
  linalg::multiply_sparse(mode.flow.a(), change.y_before.data(), rate);
  const double fall = mode.guards.row(row).dot(rate);
  const double value = mode.guards.row(row).dot(Eigen::Map<const Vector>(change.y_before.data(), mode.ny));
  return fall != 0.0 && std::abs(value) <= near * std::abs(fall);
}

template <class Form>
void superpose(Form& form, int source, int input) {
  const std::size_t terms = form.size();
  for (std::size_t i = 0; i < terms; ++i)
    if (form[i].kind == model::Term::Kind::source && form[i].index == source)
      form.push_back({model::Term::Kind::source, input, form[i].coefficient});
}

}  // namespace

int add_small_input(model::Network& network, const std::string& name, const model::SmallInput& input) {
  model::Source source;
  source.label.name = name;
  source.function = input;
  network.sources.push_back(std::move(source));
  return static_cast<int>(network.sources.size()) - 1;
}

void superpose_input(model::Network& network, int source, int input) {
  for (auto& branch : network.branches) superpose(branch.voltage, source, input);
  for (auto& injection : network.injections) superpose(injection.current, source, input);
  for (auto& item : network.complementarities) superpose(item.slack, source, input);
  for (auto& item : network.switches) superpose(item.control, source, input);
  for (auto& signal : network.signals) superpose(signal.form, source, input);
}

LinearisedOrbit::LinearisedOrbit(const engine::ExactModel& model, const Trace& trace, double period, bool is_driven,
                                 const std::vector<std::string>& inputs)
    : stacking_(model), period_(period), inputs_(inputs.size()) {
  for (const engine::IslandModel& island : model.islands) {
    std::vector<InputColumns>& own = columns_.emplace_back(inputs.size());
    const model::Exosystem& sources = *island.extraction.system.exosystem;
    for (std::size_t k = 0; k < inputs.size(); ++k)
      for (const model::Exosystem::Block& block : sources.blocks())
        if (block.source >= 0 && island.island.network.sources[static_cast<std::size_t>(block.source)].label.name == inputs[k])
          own[k] = {block.first, block.first + 1, block.rate, block.size()};
  }
  instants_.reserve(trace.steps.size());
  for (std::size_t i = 0; i < trace.steps.size(); ++i) {
    const TraceStep& step = trace.steps[i];
    if (i > 0) {
      take_step(step, trace.steps[i - 1].on, step.changes);
      take_clocks(trace.steps[i - 1].on, step.on, instants_.back());
      continue;
    }
    // The wrap: what is left of t = 0 is the end of the period. In a self-timed orbit the last instant has been it already.
    take_step(step, is_driven ? trace.steps.back().on : step.on, is_driven ? wrap_of(trace).changes : step.changes);
    if (is_driven) take_clocks(trace.steps.back().on, step.on, instants_.back());
  }
  for (const TraceSegment& s : trace.tail) tail_.push_back({s.island, s.mode, s.begin, s.length});
}

std::vector<int> LinearisedOrbit::take_impulses(const Trace& trace, bool is_driven) {
  std::vector<int> unknown;
  for (std::size_t i = 0; i < instants_.size(); ++i) {
    const std::vector<Change> changes = i == 0 && is_driven ? wrap_of(trace).changes : trace.steps[i].changes;
    for (std::size_t k = 0; k < changes.size(); ++k) {
      const System& system = stacking_.system(changes[k].island);
      Impulses impulses = impulses_of(system, changes[k]);
      for (const int output : impulses.unknown) unknown.push_back(system.output_signal[static_cast<std::size_t>(output)]);
      instants_[i].changes[k].impulses = std::move(impulses.list);
    }
  }
  return unknown;
}

std::vector<char> LinearisedOrbit::inputs_read_to_the_last() const {
  std::vector<char> is_read(inputs_, 0);
  std::set<const Mode*> followed, entered;
  const auto look_at = [&](std::size_t island, const auto& rows, Eigen::Index first) {
    for (std::size_t k = 0; k < inputs_ && rows.size() > 0; ++k) {
      const InputColumns& column = columns_[island][k];
      if (column.value >= 0 && !rows.col(first + column.value + column.count - 1).isZero(0.0)) is_read[k] = 1;
    }
  };
  const auto look_at_segment = [&](const LinearSegment& segment) {
    const Mode& mode = *segment.mode;
    if (!followed.insert(&mode).second) return;
    look_at(segment.island, mode.outputs, mode.n1);
    look_at(segment.island, mode.flow.a().topRows(mode.n1), mode.n1);
    look_at(segment.island, mode.guards, mode.n1);
    if (mode.constrained) look_at(segment.island, mode.lift, 0);
  };
  std::for_each(tail_.begin(), tail_.end(), look_at_segment);
  for (const LinearInstant& instant : instants_) {
    std::for_each(instant.segments.begin(), instant.segments.end(), look_at_segment);
    for (const LinearChange& change : instant.changes)
      for (const Mode* mode : change.by_way_of) {
        const Eigen::Index n = stacking_.count(change.island);
        if (mode->constrained && entered.insert(mode).second) look_at(change.island, mode->projector.topRows(n), n);
      }
  }
  return is_read;
}

void LinearisedOrbit::take_step(const TraceStep& step, const std::vector<char>& on_before, const std::vector<Change>& changes) {
  LinearInstant& instant = instants_.emplace_back();
  instant.time = step.time;
  for (const TraceSegment& s : step.segments) instant.segments.push_back({s.island, s.mode, s.begin, s.length});
  for (const Change& change : changes) {
    const System& system = stacking_.system(change.island);
    const int n = stacking_.count(change.island);
    if (change.cause == Cause::guard && instant.island < 0 && passes_guard(system, change, on_before, step.on))
      take_guard(change, change.guard, instant);
    LinearChange& linear = instant.changes.emplace_back();
    linear.island = change.island;
    linear.by_way_of = change.by_way_of;
    linear.d = Vector::Zero(n);
    linear.outputs = Vector::Zero(static_cast<Eigen::Index>(system.outputs.size()));
    if (change.before == nullptr || change.y_before.empty() || is_nothing(change)) continue;
    const auto is_constrained = [](const Mode* mode) { return mode->constrained; };
    if (std::any_of(change.by_way_of.begin(), change.by_way_of.end(), is_constrained)) {
      Vector before = state_speed(system, *change.before, change.y_before);
      for (const Mode* mode : change.by_way_of)
        if (mode->constrained) before = mode->projector * before;
      linear.d = before.head(n) - store_speed(system, *change.after, change.y_after);
    } else if (n > 0) {
      linear.d = store_speed(system, *change.before, change.y_before) - store_speed(system, *change.after, change.y_after);
    }
    linear.outputs = outputs_of(*change.before, change.y_before) - outputs_of(*change.after, change.y_after);
  }
  take_own_guards(changes, on_before, step.on, instant);
  for (const Change& change : changes) {
    if (!is_nothing(change)) take_beside(change, instant);
    take_controls_beside(change, on_before, step.on, instant);
  }
}

/// Parts that do not depend on one another may pass their guards at one instant, each by itself.
void LinearisedOrbit::take_own_guards(const std::vector<Change>& changes, const std::vector<char>& on_before, const std::vector<char>& on,
                                      LinearInstant& instant) const {
  if (instant.island < 0) return;
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const auto passage = passage_of(stacking_, changes[k], changes, on_before, on, tolerance::same_instant * (period_ + instant.time));
    if (!passage) continue;
    LinearGuard guard;
    take_guard(*passage->change, passage->row, guard);
    const bool is_first = guard.island == instant.island && guard.row == instant.row;
    if (guard.island >= 0 && !is_first) instant.changes[k].own = std::move(guard);
  }
}

/// Other switches that pass their threshold at the same time: what they change comes when they do.
void LinearisedOrbit::take_controls_beside(const Change& change, const std::vector<char>& on_before, const std::vector<char>& on,
                                           LinearInstant& instant) const {
  if (instant.island < 0 || change.cause != Cause::guard || change.before == nullptr || change.y_before.empty()) return;
  const System& system = stacking_.system(change.island);
  for (std::size_t k = 0; k < system.controls.size(); ++k) {
    const auto driven = static_cast<std::size_t>(system.controls[k].driven);
    if (on_before[driven] == on[driven] || system.controls[k].driven == instant.level_switch) continue;
    const int row = control_row(system, k, on_before[driven] != 0);
    if (row >= change.before->guards.rows() || !is_passed(change, row, tolerance::same_instant * (period_ + instant.time))) continue;
    const auto is_there = [&](const LinearGuard& other) { return other.island == static_cast<int>(change.island) && other.row == row; };
    if (std::any_of(instant.beside.begin(), instant.beside.end(), is_there)) continue;
    LinearGuard guard;
    take_guard(change, row, guard);
    if (guard.island >= 0) instant.beside.push_back(std::move(guard));
  }
}

/// Guards that are passed by chance at the time of another one, or of an edge.
void LinearisedOrbit::take_beside(const Change& change, LinearInstant& instant) const {
  std::vector<int> rows = guards_beside(change, tolerance::same_instant * (period_ + instant.time));
  if (static_cast<int>(change.island) == instant.island) std::erase(rows, instant.row);
  if (rows.empty() || !depends_on_order(stacking_.system(change.island), change)) return;
  for (const int row : rows) {
    LinearGuard guard;
    take_guard(change, row, guard);
    if (guard.island >= 0) instant.beside.push_back(std::move(guard));
  }
}

void LinearisedOrbit::take_guard(const Change& change, int number, LinearGuard& instant) const {
  const Mode& mode = *change.before;
  const auto row = mode.guards.row(number);
  Vector rate(mode.ny);
  linalg::multiply_sparse(mode.flow.a(), change.y_before.data(), rate);
  const double fall = row.dot(rate);
  if (fall == 0.0) return;
  instant.island = static_cast<int>(change.island);
  instant.row = number;
  const System& system = stacking_.system(change.island);
  if (number >= system.diodes) {
    instant.level_switch = system.controls[static_cast<std::size_t>(number - system.diodes) / 2].driven;
    instant.is_off_level = (number - system.diodes) % 2 == 0;
    instant.level_rate = instant.is_off_level ? fall : -fall;
  }
  const Eigen::RowVectorXd on_c = row.head(mode.n1) * (-1.0 / fall);
  instant.on_state = mode.constrained ? Eigen::RowVectorXd(on_c * mode.basis.transpose()) : on_c;
  instant.on_w.assign(inputs_, 0.0);
  instant.on_slope.assign(inputs_, 0.0);
  for (std::size_t k = 0; k < inputs_; ++k) {
    const InputColumns& column = columns_[change.island][k];
    if (column.value < 0) continue;
    instant.on_w[k] = -row[mode.n1 + column.value] / fall;
    instant.on_slope[k] = -row[mode.n1 + column.slope] / (fall * column.rate);
    if (column.count <= 2) continue;
    if (instant.on_derivatives.size() == 0) instant.on_derivatives = Matrix::Zero(static_cast<Eigen::Index>(inputs_), column.count - 2);
    for (int order = 2; order < column.count; ++order)
      instant.on_derivatives(static_cast<Eigen::Index>(k), order - 2) =
          -row[mode.n1 + column.value + order] / (fall * std::pow(column.rate, order));
  }
}

/// A switch that sources alone drive, and that one of them crosses rather than jumps past: inputs among these sources move its time.
void LinearisedOrbit::take_clocks(const std::vector<char>& on_before, const std::vector<char>& on, LinearInstant& instant) {
  const double time = instant.time > 0.0 ? instant.time : period_;
  for (std::size_t island = 0; island < stacking_.islands(); ++island) {
    const System& system = stacking_.system(island);
    for (const model::Control& control : system.clocked) {
      const auto driven = static_cast<std::size_t>(control.driven);
      if (on_before[driven] == on[driven]) continue;
      const ClockValue at = clock_value(system, control, time);
      const double level = on_before[driven] != 0 ? control.off_level : control.on_level;
      if (at.slope == 0.0 || std::abs(at.value - level) > tolerance::on_level * (at.size + std::abs(level))) continue;
      LinearGuard guard;
      guard.on_w.assign(inputs_, 0.0);
      guard.on_slope.assign(inputs_, 0.0);
      for (std::size_t k = 0; k < inputs_; ++k)
        if (const InputColumns& column = columns_[island][k]; column.value >= 0)
          guard.on_w[k] = -control.value.state[system.n + column.value] / at.slope;
      guard.level_switch = control.driven;
      guard.is_off_level = on_before[driven] != 0;
      guard.level_rate = at.slope;
      const bool is_first = instant.island < 0 && instant.level_switch < 0;
      if (is_first)
        static_cast<LinearGuard&>(instant) = std::move(guard);
      else
        instant.beside.push_back(std::move(guard));
    }
  }
}

}  // namespace pwlsim::steady
