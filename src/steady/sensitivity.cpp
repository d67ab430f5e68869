#include "steady/sensitivity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/legendre.hpp"
#include "model/store_values.hpp"

namespace pwlsim::steady {
namespace {

using engine::Change;
using model::Mode;
using model::System;

/// Of the run and of a time: edges this near are one.
constexpr double same_time = 1e-12;
/// Two shifts of one instant that differ by less are one.
constexpr double same_shift = 1e-9;
/// Two shifts that differ by less of the run, for a change by all of the parameter, are one.
constexpr double no_shift = 1e-11;

Vector vector_of(const std::vector<double>& y) { return Eigen::Map<const Vector>(y.data(), static_cast<Eigen::Index>(y.size())); }

/// A row over x = (ξ, ζ) as one over y = (c, ζ).
Eigen::RowVectorXd in_mode(const Mode& mode, int n, const Eigen::RowVectorXd& row) {
  if (!mode.constrained) return row;
  Eigen::RowVectorXd y(mode.ny);
  y.head(mode.n1) = row.head(n) * mode.basis;
  y.tail(mode.ny - mode.n1) = row.head(n) * mode.lift + row.tail(row.size() - n);
  return y;
}

}  // namespace

Sensitivity::Sensitivity(const engine::ExactModel& model, const Trace& trace, const LinearisedOrbit& orbit, const SensitivityInputs& inputs,
                         bool is_settled)
    : model_(model), trace_(trace), orbit_(orbit), inputs_(inputs), is_settled_(is_settled), of_island_(model.islands.size()) {
  for (std::size_t island = 0; island < model.islands.size(); ++island) {
    const System& system = orbit.stacking().system(island);
    std::vector<char> is_input(static_cast<std::size_t>(system.size() - system.n), 0);
    for (std::size_t k = 0; k < orbit.inputs(); ++k)
      if (const InputColumns& column = orbit.columns(island, k); column.value >= 0)
        is_input[static_cast<std::size_t>(column.value)] = is_input[static_cast<std::size_t>(column.slope)] = 1;
    auto& kept = kept_.emplace_back();
    for (std::size_t k = 0; k < is_input.size(); ++k)
      if (is_input[k] == 0) kept.push_back(static_cast<Eigen::Index>(k));
  }
  for (const TraceStep& step : trace.steps) {
    first_.push_back(segments_.size());
    for (const TraceSegment& segment : step.segments) add(segment);
  }
  first_.push_back(segments_.size());
  for (const TraceSegment& segment : trace.tail) add(segment);
  for (std::size_t s = 0; s < segments_.size(); ++s) find_rests(s);
  add_static_parts();
  if (is_settled && !trace.steps.empty()) wrap_ = wrap_of(trace);
  for (const engine::IslandModel& island : model.islands) {
    const model::StoreValues values(island.island, island.extraction);
    auto& rows = stores_.emplace_back();
    for (const model::Source& source : island.island.network.sources) {
      Wave wave{-1, source.function, source.function, -1, source.label.name};
      if (std::holds_alternative<model::Pulse>(source.function))
        wave.derivative = model::Pulse{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
      else if (!std::holds_alternative<model::Pwl>(source.function))
        continue;
      const auto same = [&](const Wave& other) { return other.name == wave.name; };
      const bool is_input = std::find(inputs.names.begin(), inputs.names.end(), wave.name) != inputs.names.end();
      if (!is_input && std::none_of(jumping_.begin(), jumping_.end(), same)) jumping_.push_back(std::move(wave));
    }
    for (std::size_t k = 0; k < values.names().size(); ++k) rows[values.names()[k]] = values.rows().row(static_cast<Eigen::Index>(k));
  }
  for (std::size_t p = 0; p < inputs.parameters.size(); ++p) {
    const auto& waves = inputs.parameters[p].waves;
    sound_.push_back(check(p).empty() ? 1 : 0);
    if (sound_[p] != 0) all_.waves.insert(all_.waves.end(), waves.begin(), waves.end());
  }
}

namespace {

/// Nothing but sources: runs evaluate them when they are read.
bool is_static(const System& system) { return system.n == 0 && system.ports == 0; }

}  // namespace

Vector Sensitivity::seen(std::size_t island, const Mode& mode, const double* y) const {
  const auto& kept = kept_[island];
  Vector own(mode.n1 + static_cast<Eigen::Index>(kept.size()));
  own.head(mode.n1) = Eigen::Map<const Vector>(y, mode.n1);
  for (std::size_t k = 0; k < kept.size(); ++k) own[mode.n1 + static_cast<Eigen::Index>(k)] = y[mode.n1 + kept[k]];
  return own;
}

Eigen::RowVectorXd Sensitivity::seen_row(std::size_t island, const Mode& mode, const Eigen::RowVectorXd& row) const {
  return seen(island, mode, row.data()).transpose();
}

void Sensitivity::add(const TraceSegment& segment) {
  if (!is_static(orbit_.stacking().system(segment.island))) of_island_[segment.island].push_back(segments_.size());
  segments_.push_back({segment.island, segment.mode, segment.begin, segment.length, &segment.y0, &segment.y1});
  length_ = std::max(length_, segments_.back().end());
}

void Sensitivity::add_static_parts() {
  static_first_ = segments_.size();
  length_ = std::max(length_, orbit_.period());
  const double near = same_time * length_;
  for (std::size_t island = 0; island < of_island_.size(); ++island) {
    const System& system = orbit_.stacking().system(island);
    if (!is_static(system) || trace_.steps.empty()) continue;
    const Mode* mode = nullptr;
    for (const Change& change : trace_.steps.front().changes)
      if (change.island == island) mode = change.after;
    if (mode == nullptr) continue;
    model::Exosystem::Phase phase = system.exosystem->start();
    for (double begin = 0.0; begin < length_;) {
      if (phase.next <= begin + near) (void)system.exosystem->advance(phase, begin, near);
      const double end = std::min(phase.next, length_);
      for (const double time : {begin, end})
        system.exosystem->evaluate(phase, time, sources_.emplace_back(static_cast<std::size_t>(mode->ny), 0.0).data());
      of_island_[island].push_back(segments_.size());
      segments_.push_back({island, mode, begin, end - begin, &sources_[sources_.size() - 2], &sources_.back()});
      if (!(end > begin)) break;
      begin = end;
    }
  }
}

/// A signal that drives an input must be that of the island which reads the input.
std::string Sensitivity::check(std::size_t parameter) const {
  const ParameterInputs& own = inputs_.parameters[parameter];
  if (!own.failure.empty()) return own.failure;
  for (const Wave& wave : own.waves)
    if (std::string why = wave_failure(wave); !why.empty()) return why;
  for (const Drive& drive : own.drives)
    for (std::size_t island = 0; island < model_.islands.size(); ++island) {
      const System& system = orbit_.stacking().system(island);
      const bool reads = orbit_.columns(island, static_cast<std::size_t>(drive.input)).value >= 0;
      if (drive.held) continue;
      if (reads && drive.signal < 0 && stores_[island].count(drive.store) == 0) return "what it drives lies in another part of the circuit";
      const bool gives = drive.signal >= 0 &&
                         std::find(system.output_signal.begin(), system.output_signal.end(), drive.signal) != system.output_signal.end();
      if (gives && !reads) return "what it drives lies in another part of the circuit";
    }
  return "";
}

Eigen::RowVectorXd Sensitivity::drive_row(const Drive& drive, std::size_t island, const Mode& mode) const {
  const System& system = orbit_.stacking().system(island);
  if (drive.held) {
    const model::Exosystem& sources = *system.exosystem;
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(mode.ny);
    const auto& local = model_.islands[island].island.network.sources;
    for (const auto& [name, coefficient] : drive.held->sources)
      for (std::size_t k = 0; k < local.size(); ++k)
        if (local[k].label.name == name)
          row.tail(system.n_zeta) += drive.weight * coefficient * sources.rows().row(static_cast<Eigen::Index>(k));
    if (drive.held->constant != 0.0 && sources.constant() >= 0) row[mode.n1 + sources.constant()] += drive.weight * drive.held->constant;
    return seen_row(island, mode, row);
  }
  if (drive.signal < 0) return seen_row(island, mode, drive.weight * in_mode(mode, system.n, stores_[island].at(drive.store)));
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(mode.ny);
  for (std::size_t k = 0; k < system.output_signal.size(); ++k)
    if (system.output_signal[k] == drive.signal) row += drive.weight * mode.outputs.row(static_cast<Eigen::Index>(k));
  return seen_row(island, mode, row);
}

void Sensitivity::add_drives(std::size_t parameter, std::size_t island, const Mode& mode, Flow& flow) const {
  const ParameterInputs& own = inputs_of_number(parameter);
  const auto reads = [&](int input) { return is_read(input, island); };
  std::vector<int> first;
  for (std::size_t k = 0; k < own.waves.size(); ++k) {
    if (!reads(own.waves[k].input)) continue;
    flow.waves.push_back(k);
    first.push_back(flow.nz);
    flow.nz += wave_size(own.waves[k]);
  }
  const auto& kept = kept_[island];
  flow.ny = mode.n1 + static_cast<int>(kept.size());
  const Eigen::Index width = flow.ny + flow.nz;
  flow.source = Matrix::Zero(width, width);
  for (Eigen::Index k = 0; k < flow.ny; ++k) {
    const Eigen::Index column = k < mode.n1 ? k : mode.n1 + kept[static_cast<std::size_t>(k - mode.n1)];
    flow.source.col(k).head(flow.ny) = seen(island, mode, mode.flow.a().col(column).eval().data());
  }
  flow.rows.resize(orbit_.inputs());
  const auto row_of = [&](int input) -> Eigen::RowVectorXd& {
    Eigen::RowVectorXd& row = flow.rows[static_cast<std::size_t>(input)];
    if (row.size() == 0) row = Eigen::RowVectorXd::Zero(width);
    return row;
  };
  for (std::size_t k = 0; k < flow.waves.size(); ++k) {
    const Wave& wave = own.waves[flow.waves[k]];
    const int at = flow.ny + first[k], size = wave_size(wave);
    flow.source.block(at, at, size, size) = wave_generator(wave);
    row_of(wave.input).segment(at, size) += wave_row(wave);
  }
  for (const Drive& drive : own.drives)
    if (reads(drive.input)) row_of(drive.input).head(flow.ny) += drive_row(drive, island, mode);
}

const Sensitivity::Flow& Sensitivity::flow_of(std::size_t parameter, std::size_t island, const Mode& mode) const {
  const auto known = flows_.find({parameter, &mode});
  if (known != flows_.end()) return known->second;
  Flow& flow = flows_[{parameter, &mode}];
  add_drives(parameter, island, mode, flow);
  const Eigen::Index width = flow.ny + flow.nz, n1 = mode.n1;
  Matrix drive = Matrix::Zero(n1, width);
  flow.outputs = Matrix::Zero(mode.outputs.rows(), width);
  for (std::size_t k = 0; k < flow.rows.size(); ++k) {
    if (flow.rows[k].size() == 0) continue;
    const InputColumns& column = orbit_.columns(island, k);
    const Eigen::RowVectorXd rate = flow.rows[k] * flow.source / column.rate;
    drive += mode.flow.a().col(n1 + column.value).head(n1) * flow.rows[k] + mode.flow.a().col(n1 + column.slope).head(n1) * rate;
    flow.outputs += mode.outputs.col(n1 + column.value) * flow.rows[k] + mode.outputs.col(n1 + column.slope) * rate;
  }
  Matrix block = Matrix::Zero(width + n1, width + n1);
  block.topLeftCorner(width, width) = flow.source;
  const double rate = std::max(mode.flow.rate(), linalg::norm_bound(flow.source.bottomRightCorner(flow.nz, flow.nz)));
  const double size = linalg::norm_bound(drive);
  if (size > 0.0) flow.scale = rate > 0.0 ? size / rate : size;
  block.bottomLeftCorner(n1, width) = drive / flow.scale;
  block.bottomRightCorner(n1, n1) = mode.flow.a().topLeftCorner(n1, n1);
  const double bound = size > 0.0 ? 2.0 * rate : rate;
  flow.block = std::make_unique<linalg::Exponential>(std::move(block), bound > 0.0 ? bound : 1e-30);
  if (parameter == inputs_.parameters.size()) flow.signals = std::make_unique<linalg::Exponential>(flow.source, rate > 0.0 ? rate : 1e-30);
  return flow;
}

int Sensitivity::first_of_waves(std::size_t parameter, std::size_t island) const {
  int first = 0;
  for (std::size_t p = 0; p < parameter; ++p)
    for (const Wave& wave : inputs_.parameters[p].waves)
      if (sound_[p] != 0 && is_read(wave.input, island)) first += wave_size(wave);
  return first;
}

Vector Sensitivity::waves_at(const Flow& flow, std::size_t parameter, double time, double inside) const {
  Vector z(flow.nz);
  int first = 0;
  for (const std::size_t k : flow.waves) {
    const Wave& wave = inputs_of_number(parameter).waves[k];
    z.segment(first, wave_size(wave)) = wave_state(wave, time, inside, is_settled_);
    first += wave_size(wave);
  }
  return z;
}

/// (y, z, c_p) at the begin of a segment.
Vector Sensitivity::begin_of(std::size_t parameter, const Segment& segment, const Vector& xi) const {
  const Mode& mode = *segment.mode;
  const Flow& flow = flow_of(parameter, segment.island, mode);
  Vector state(flow.ny + flow.nz + mode.n1);
  state.head(flow.ny) = seen(segment.island, mode, segment.y0->data());
  state.segment(flow.ny, flow.nz) = waves_at(flow, parameter, segment.begin, segment.inside());
  state.tail(mode.n1) = (mode.constrained ? Vector(mode.basis.transpose() * xi) : xi) / flow.scale;
  return state;
}

Vector Sensitivity::at(const Flow& flow, const Segment&, const Vector& begin, double since) const {
  Vector state = begin, work(2 * begin.size());
  if (since > 0.0) flow.block->apply(since, state.data(), work.data());
  return state;
}

/// Σ (column of the value)·w + (column of the slope)·w′ from `first` on.
Vector Sensitivity::inputs_of(const Flow& flow, std::size_t island, const Matrix& columns, int first, const Vector& yz) const {
  Vector sum = Vector::Zero(columns.rows());
  const Vector rate = flow.source * yz;
  for (std::size_t k = 0; k < flow.rows.size(); ++k) {
    if (flow.rows[k].size() == 0) continue;
    const InputColumns& column = orbit_.columns(island, k);
    sum += columns.col(first + column.value) * flow.rows[k].dot(yz) +
           columns.col(first + column.slope) * (flow.rows[k].dot(rate) / column.rate);
  }
  return sum;
}

void Sensitivity::pass_segment(std::size_t parameter, std::size_t number, Vector& xi, Followed& followed) const {
  const Segment& segment = segments_[number];
  const Mode& mode = *segment.mode;
  const Stacking& stacking = orbit_.stacking();
  auto block = xi.segment(stacking.first(segment.island), stacking.count(segment.island));
  const Flow& flow = flow_of(parameter, segment.island, mode);
  followed.begins[number] = begin_of(parameter, segment, block);
  if (!rests_.empty()) check_rests(parameter, number, followed);
  const Vector end = at(flow, segment, followed.begins[number], segment.length);
  const Vector c = end.tail(mode.n1) * flow.scale;
  if (mode.constrained)
    block = mode.basis * c + inputs_of(flow, segment.island, mode.lift, 0, end.head(flow.ny + flow.nz));
  else
    block = c;
}

std::optional<double> Sensitivity::edge_shift_of(std::size_t parameter, double time, Followed& followed) const {
  std::optional<double> shift;
  const double near = same_time * (length_ + time);
  for (const Wave& wave : inputs_.parameters[parameter].waves) {
    const std::optional<double> own = edge_shift(wave, time, near, is_settled_);
    if (!own) continue;
    if (shift && std::abs(*own - *shift) > same_shift * (std::abs(*own) + std::abs(*shift)))
      followed.fail(fmt::format("edges of {} at t = {} s move differently", wave.name, time), true);
    if (!shift) shift = own;
  }
  return shift;
}

/// An edge that moves must be alone at its instant.
void Sensitivity::check_others(std::size_t parameter, const LinearInstant& instant, Followed& followed) const {
  const auto& waves = inputs_.parameters[parameter].waves;
  if (instant.island >= 0)
    followed.fail(fmt::format("an edge that moves meets another event, {}, at t = {} s", name_of(instant), instant.time), true);
  for (const Wave& other : jumping_) {
    const bool is_own = std::any_of(waves.begin(), waves.end(), [&](const Wave& wave) { return wave.name == other.name; });
    if (is_own || !edge_shift(other, instant.time, same_time * (length_ + instant.time), is_settled_)) continue;
    followed.fail(fmt::format("an edge that moves meets one of {} at t = {} s, which does not", other.name, instant.time), true);
  }
}

/// The diode or switch behind a guard.
std::string Sensitivity::name_of(const LinearGuard& guard) const {
  if (guard.level_switch >= 0) return model_.switches[static_cast<std::size_t>(guard.level_switch)].name;
  return orbit_.stacking().system(static_cast<std::size_t>(guard.island)).port[static_cast<std::size_t>(guard.row)].name;
}

/// Of an instant that a clock decides, or nothing that moves.
double Sensitivity::clock_shift_of(std::size_t parameter, const LinearInstant& instant) const {
  double shift = 0.0;
  if (instant.on_w.empty()) return shift;
  const double time = instant.time > 0.0 ? instant.time : length_;
  for (const Wave& wave : inputs_.parameters[parameter].waves) {
    const double on_w = instant.on_w[static_cast<std::size_t>(wave.input)];
    if (on_w == 0.0) continue;
    const double left = time - same_time * (length_ + time);
    shift += on_w * wave_row(wave).dot(wave_state(wave, time, left, is_settled_));
  }
  return shift;
}

double Sensitivity::shift_of(std::size_t parameter, std::size_t number, const Vector& xi, Followed& followed) const {
  const LinearInstant& instant = orbit_.instants()[number];
  if (const auto edge = edge_shift_of(parameter, instant.time, followed)) {
    if (*edge != 0.0) check_others(parameter, instant, followed);
    return *edge;
  }
  const double level = level_shift_of(parameter, instant);
  return level + (instant.island < 0 ? clock_shift_of(parameter, instant) : passage_of(parameter, number, instant, xi));
}

double Sensitivity::corner_shift_of(std::size_t parameter, const LinearInstant& instant) const {
  if (instant.island >= 0 || instant.level_switch >= 0) return 0.0;
  for (const Wave& wave : inputs_.parameters[parameter].waves)
    if (const auto shift = corner_shift(wave, instant.time, same_time * (length_ + instant.time), is_settled_)) return *shift;
  return 0.0;
}

double Sensitivity::level_shift_of(std::size_t parameter, const LinearGuard& guard) const {
  double shift = 0.0;
  for (const LevelMove& level : inputs_.parameters[parameter].levels)
    if (level.number == guard.level_switch) shift += (guard.is_off_level ? level.off : level.on) / guard.level_rate;
  return shift;
}

double Sensitivity::passage_of(std::size_t parameter, std::size_t number, const LinearGuard& guard, const Vector& xi) const {
  const auto island = static_cast<std::size_t>(guard.island);
  const Stacking& stacking = orbit_.stacking();
  const double time = orbit_.instants()[number].time;
  double shift = guard.on_state * xi.segment(stacking.first(island), stacking.count(island));
  const bool is_wrap = number == 0 && is_settled_;
  for (const Change& change : is_wrap ? wrap_.changes : trace_.steps[number].changes) {
    if (change.island != island || change.before == nullptr) continue;
    const Flow& flow = flow_of(parameter, island, *change.before);
    Vector yz(flow.ny + flow.nz);
    yz << seen(island, *change.before, change.y_before.data()), waves_at(flow, parameter, time, time - same_time * (length_ + time));
    const Vector rate = flow.source * yz;
    for (std::size_t k = 0; k < flow.rows.size(); ++k)
      if (flow.rows[k].size() > 0) shift += guard.on_w[k] * flow.rows[k].dot(yz) + guard.on_slope[k] * flow.rows[k].dot(rate);
    break;
  }
  return shift;
}

/// What is passed at the same time by chance is passed apart for other values of the parameter, in one order or the other.
void Sensitivity::check_beside(std::size_t parameter, std::size_t number, double shift, const Vector& xi, Followed& followed) const {
  const double value = std::abs(inputs_.parameters[parameter].value), rounding = no_shift * length_;
  const double time = orbit_.instants()[number].time;
  for (const LinearGuard& guard : orbit_.instants()[number].beside) {
    const double own = level_shift_of(parameter, guard) + passage_of(parameter, number, guard, xi), apart = std::abs(own - shift);
    if (apart * value <= rounding || apart <= same_shift * (std::abs(own) + std::abs(shift))) continue;
    followed.fail(
        fmt::format("{} changes at t = {} s together with another event, and the parameter moves them apart", name_of(guard), time), true);
  }
}

/// y in each mode that a change goes by way of, where it is constrained. Where one is entered for no time, its sources are those of the mode after.
std::vector<Vector> Sensitivity::states_by_way(const Change& change) const {
  const System& system = orbit_.stacking().system(change.island);
  std::vector<Vector> states(change.by_way_of.size());
  Vector x(system.size());
  model::from_mode(system, *change.after, change.y_after.data(), x.data());
  for (std::size_t k = 0; k < states.size(); ++k) {
    const Mode& mode = *change.by_way_of[k];
    if (!mode.constrained) continue;
    states[k].resize(mode.ny);
    if (&mode == change.after)
      states[k] = vector_of(change.y_after);
    else
      model::to_mode(system, mode, x.data(), states[k].data());
  }
  return states;
}

void Sensitivity::pass_change(std::size_t parameter, const Change& change, const LinearChange& linear, double time, double shift,
                              Vector& xi) const {
  const Stacking& stacking = orbit_.stacking();
  const int n = stacking.count(change.island);
  if (n == 0) return;
  auto block = xi.segment(stacking.first(change.island), n);
  const std::vector<Vector> states = states_by_way(change);
  for (std::size_t k = 0; k < states.size(); ++k) {
    const Mode& mode = *change.by_way_of[k];
    if (!mode.constrained) continue;
    const Flow& flow = flow_of(parameter, change.island, mode);
    Vector yz(flow.ny + flow.nz);
    yz << seen(change.island, mode, states[k].data()), waves_at(flow, parameter, time, time + same_time * (length_ + time));
    block = mode.projector.topLeftCorner(n, n) * Vector(block) + inputs_of(flow, change.island, mode.projector, n, yz).head(n);
  }
  if (linear.d.size() > 0) block += linear.d * shift;
}

void Sensitivity::check_changes(std::size_t number, Followed& followed) const {
  const double time = orbit_.instants()[number].time;
  for (const Change& change : trace_.steps[number].changes) {
    if (change.cause == engine::Cause::accumulation) followed.fail(fmt::format("events accumulate at t = {} s", time), false);
    if (change.cause == engine::Cause::undecided && change.before != change.after)
      followed.fail(fmt::format("the event at t = {} s could not be told from others", time), false);
  }
}

void Sensitivity::pass_instant(std::size_t parameter, std::size_t number, Vector& xi, Followed& followed) const {
  const LinearInstant& instant = orbit_.instants()[number];
  const double shift = shift_of(parameter, number, xi, followed);
  followed.shifts[number] = shift != 0.0 ? shift : corner_shift_of(parameter, instant);
  check_changes(number, followed);
  check_beside(parameter, number, shift, xi, followed);
  const auto& changes = trace_.steps[number].changes;
  for (std::size_t k = 0; k < changes.size(); ++k) pass_change(parameter, changes[k], instant.changes[k], instant.time, shift, xi);
}

Followed Sensitivity::follow(std::size_t parameter, const Vector& start, std::size_t segments) const {
  Followed followed;
  followed.begins.resize(segments_.size());
  followed.shifts.assign(orbit_.instants().size(), 0.0);
  followed.failure = check(parameter);
  if (!followed.failure.empty()) return followed;
  Vector xi = start;
  for (std::size_t i = 0; i < orbit_.instants().size(); ++i) {
    for (std::size_t s = first_[i]; s < first_[i + 1]; ++s) pass_segment(parameter, s, xi, followed);
    if (segments < static_first_ && first_[i + 1] >= segments) return followed;
    pass_instant(parameter, i, xi, followed);
  }
  for (std::size_t s = first_.back(); s < static_first_; ++s) pass_segment(parameter, s, xi, followed);
  for (std::size_t s = static_first_; s < segments_.size(); ++s) followed.begins[s] = begin_of(parameter, segments_[s], Vector());
  followed.end = xi;
  if (followed.failure.empty() && !xi.allFinite()) followed.failure = "its derivative leaves the range of numbers";
  return followed;
}

const Sensitivity::Segment* Sensitivity::segment_at(std::size_t island, double time, Side side) const {
  const auto& list = of_island_[island];
  if (list.empty()) return nullptr;
  const double near = same_time * (length_ + time);
  // The first that ends behind the time, or at it on its left.
  auto found = std::partition_point(list.begin(), list.end(), [&](std::size_t s) {
    const double end = segments_[s].end();
    return side == Side::right ? end <= time + near : end < time - near;
  });
  if (found == list.end()) --found;
  return &segments_[*found];
}

std::vector<Sensitivity::Share> Sensitivity::shares_of(std::size_t island, const std::vector<int>& signals) const {
  std::vector<Share> shares;
  const auto& own = orbit_.stacking().system(island).output_signal;
  for (std::size_t k = 0; k < own.size(); ++k)
    for (std::size_t j = 0; j < signals.size(); ++j)
      if (own[k] == signals[j]) shares.emplace_back(static_cast<Eigen::Index>(k), j);
  return shares;
}

std::vector<MovedJet> Sensitivity::moved_signals_at(const Followed& followed, std::size_t parameter, const std::vector<int>& signals,
                                                    double time, Side side) const {
  std::vector<MovedJet> jets(signals.size());
  for (std::size_t island = 0; island < model_.islands.size(); ++island) {
    const std::vector<Share> shares = shares_of(island, signals);
    const Segment* const segment = shares.empty() ? nullptr : segment_at(island, time, side);
    if (segment == nullptr) continue;
    const Mode& mode = *segment->mode;
    const Flow& flow = flow_of(parameter, island, mode);
    const Vector state = at(flow, *segment, followed.begins[static_cast<std::size_t>(segment - segments_.data())],
                            std::clamp(time - segment->begin, 0.0, segment->length));
    const Vector rate = flow.block->a() * state;
    const Eigen::Index width = flow.ny + flow.nz;
    for (const auto& [row, signal] : shares) {
      const auto moved = [&, row = row](const Vector& v) {
        return mode.outputs.row(row).head(mode.n1).dot(v.tail(mode.n1)) * flow.scale + flow.outputs.row(row).dot(v.head(width));
      };
      jets[signal].moved += moved(state);
      jets[signal].moved_rate += moved(rate);
    }
  }
  return jets;
}

std::vector<SignalJet> Sensitivity::signals_at(const std::vector<int>& signals, double time, Side side) const {
  std::vector<SignalJet> jets(signals.size());
  for (std::size_t island = 0; island < model_.islands.size(); ++island) {
    const std::vector<Share> shares = shares_of(island, signals);
    const Segment* const segment = shares.empty() ? nullptr : segment_at(island, time, side);
    if (segment == nullptr) continue;
    const double since = std::clamp(time - segment->begin, 0.0, segment->length);
    const bool is_end = since > 0.0 && segment->length - since <= same_time * same_time * (length_ + time);
    Vector y = vector_of(is_end ? *segment->y1 : *segment->y0), work(2 * y.size());
    if (since > 0.0 && !is_end) segment->mode->flow.apply(since, y.data(), work.data());
    const Vector rate = segment->mode->flow.a() * y;
    for (const auto& [row, signal] : shares) {
      jets[signal].value += segment->mode->outputs.row(row).dot(y);
      jets[signal].rate += segment->mode->outputs.row(row).dot(rate);
    }
  }
  return jets;
}

bool Sensitivity::may_jump(std::size_t instant, const std::vector<int>& signals) const {
  constexpr double rounding = 64.0 * std::numeric_limits<double>::epsilon();
  for (std::size_t island = 0; island < model_.islands.size(); ++island)
    if (is_static(orbit_.stacking().system(island)) && !shares_of(island, signals).empty()) return true;  // such parts have no changes
  for (const Change& change : trace_.steps[instant].changes) {
    const std::vector<Share> shares = shares_of(change.island, signals);
    if (shares.empty()) continue;
    if (change.before == nullptr || change.y_before.empty()) return true;
    const Eigen::Map<const Vector> before(change.y_before.data(), change.before->ny), after(change.y_after.data(), change.after->ny);
    for (const auto& [row, signal] : shares) {
      const double left = change.before->outputs.row(row).dot(before), right = change.after->outputs.row(row).dot(after);
      if (!(std::abs(left - right) <= rounding * (std::abs(left) + std::abs(right)))) return true;
    }
  }
  return false;
}

const Sensitivity::Flow::Integral& Sensitivity::integral_of(const Flow& flow, const Eigen::RowVectorXd& row) const {
  for (const Flow::Integral& known : flow.integrals)
    if (known.row == row) return known;
  Flow::Integral& own = flow.integrals.emplace_back();
  const Matrix& a = flow.block->a();
  const Eigen::Index size = a.rows();
  const double rate = flow.block->rate(), weight = row.norm();
  own.row = row;
  own.scale = weight > 0.0 ? weight / rate : 1.0;
  Matrix block = Matrix::Zero(size + 1, size + 1);
  block.topLeftCorner(size, size) = a;
  block.bottomLeftCorner(1, size) = row / own.scale;
  own.block = std::make_unique<linalg::Exponential>(std::move(block), 2.0 * rate);
  return own;
}

double Sensitivity::moved_over(const Followed& followed, std::size_t parameter, const std::vector<int>& signals,
                               const Functional::Stretch& stretch) const {
  long double sum = 0.0L;
  for (std::size_t island = 0; island < model_.islands.size(); ++island) {
    const std::vector<Share> shares = shares_of(island, signals);
    if (shares.empty()) continue;
    for (const std::size_t number : of_island_[island]) {
      const Segment& segment = segments_[number];
      const double from = std::max(segment.begin, stretch.begin), to = std::min(segment.end(), stretch.end);
      if (!(from < to)) continue;
      const Mode& mode = *segment.mode;
      const Flow& flow = flow_of(parameter, island, mode);
      Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(flow.ny + flow.nz + mode.n1);
      for (const auto& [output, signal] : shares) {
        row.head(flow.ny + flow.nz) += stretch.weights[signal] * flow.outputs.row(output);
        row.tail(mode.n1) += stretch.weights[signal] * flow.scale * mode.outputs.row(output).head(mode.n1);
      }
      if (row.isZero(0.0)) continue;
      const Flow::Integral& integral = integral_of(flow, row);
      Vector state(row.size() + 1), work(2 * state.size());
      state << at(flow, segment, followed.begins[number], from - segment.begin), 0.0;
      integral.block->apply(to - from, state.data(), work.data());
      sum += static_cast<long double>(state[row.size()]) * integral.scale;
    }
  }
  return static_cast<double>(sum);
}

std::vector<std::vector<double>> Sensitivity::moved_at(const Followed& followed, std::size_t parameter, const std::vector<int>& signals,
                                                       double inside, double begin, double length) const {
  constexpr int worth_a_matrix = 24;  // so many uses
  const auto& rule = linalg::gauss_legendre();
  std::vector<std::vector<double>> values(linalg::legendre_points, std::vector<double>(signals.size(), 0.0));
  for (std::size_t island = 0; island < model_.islands.size(); ++island) {
    const std::vector<Share> shares = shares_of(island, signals);
    const Segment* const segment = shares.empty() ? nullptr : segment_at(island, inside, Side::right);
    if (segment == nullptr) continue;
    const Mode& mode = *segment->mode;
    const Flow& flow = flow_of(parameter, island, mode);
    const Eigen::Index width = flow.ny + flow.nz;
    Matrix rows(static_cast<Eigen::Index>(shares.size()), width + mode.n1);
    for (std::size_t k = 0; k < shares.size(); ++k)
      rows.row(static_cast<Eigen::Index>(k)) << flow.outputs.row(shares[k].first),
          mode.outputs.row(shares[k].first).head(mode.n1) * flow.scale;
    Vector state = at(flow, *segment, followed.begins[static_cast<std::size_t>(segment - segments_.data())], begin - segment->begin),
           work(2 * state.size());
    Flow::Points& points = flow.points[length];
    if (points.rows.size() == 0 && ++points.uses >= worth_a_matrix) {
      points.rows.resize(rows.rows() * static_cast<Eigen::Index>(linalg::legendre_points), rows.cols());
      for (std::size_t i = 0; i < linalg::legendre_points; ++i)
        points.rows.middleRows(static_cast<Eigen::Index>(i) * rows.rows(), rows.rows()) =
            rows + rows * flow.block->minus_identity(0.5 * (rule.point[i] + 1.0) * length);
    }
    double since = 0.0;
    const Vector all = points.rows.size() > 0 ? Vector(points.rows * state) : Vector();
    for (std::size_t i = 0; i < linalg::legendre_points; ++i) {
      Vector own;
      if (all.size() > 0) {
        own = all.segment(static_cast<Eigen::Index>(i) * rows.rows(), rows.rows());
      } else {
        const double next = 0.5 * (rule.point[i] + 1.0) * length;
        flow.block->apply_once(next - since, state.data(), work.data());
        since = next;
        own = rows * state;
      }
      for (std::size_t k = 0; k < shares.size(); ++k) values[i][shares[k].second] += own[static_cast<Eigen::Index>(k)];
    }
  }
  return values;
}

}  // namespace pwlsim::steady
