#include "steady/sensitivity.hpp"
#include "steady/tolerances.hpp"

#include <algorithm>
#include <cmath>

#include "model/store_values.hpp"

namespace pwlsim::steady {
namespace {

using engine::Change;
using model::Mode;
using model::System;

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
  find_kept_sources();
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
    find_jumping_sources(island);
    const model::StoreValues values(island.island, island.extraction);
    auto& rows = stores_.emplace_back();
    for (std::size_t k = 0; k < values.names().size(); ++k) rows[values.names()[k]] = values.rows().row(static_cast<Eigen::Index>(k));
  }
  read_to_the_last_ = orbit.inputs_read_to_the_last();
  for (std::size_t p = 0; p < inputs.parameters.size(); ++p) {
    const auto& waves = inputs.parameters[p].waves;
    sound_.push_back(check(p).empty() ? 1 : 0);
    if (sound_[p] != 0) all_.waves.insert(all_.waves.end(), waves.begin(), waves.end());
  }
}

/// Of each island, the states of its sources that are no inputs.
void Sensitivity::find_kept_sources() {
  for (std::size_t island = 0; island < model_.islands.size(); ++island) {
    const System& system = orbit_.stacking().system(island);
    std::vector<char> is_input(static_cast<std::size_t>(system.size() - system.n), 0);
    for (std::size_t k = 0; k < orbit_.inputs(); ++k)
      if (const InputColumns& column = orbit_.columns(island, k); column.value >= 0)
        std::fill_n(is_input.begin() + column.value, column.count, 1);
    auto& kept = kept_.emplace_back();
    for (std::size_t k = 0; k < is_input.size(); ++k)
      if (is_input[k] == 0) kept.push_back(static_cast<Eigen::Index>(k));
  }
}

/// Sources with edges that are no inputs.
void Sensitivity::find_jumping_sources(const engine::IslandModel& island) {
  for (const model::Source& source : island.island.network.sources) {
    Wave wave{-1, source.function, source.function, -1, source.label.name};
    if (std::holds_alternative<model::Pulse>(source.function))
      wave.derivative = model::Pulse{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    else if (!std::holds_alternative<model::Pwl>(source.function))
      continue;
    const auto same = [&](const Wave& other) { return other.name == wave.name; };
    const bool is_input = std::find(inputs_.names.begin(), inputs_.names.end(), wave.name) != inputs_.names.end();
    if (!is_input && std::none_of(jumping_.begin(), jumping_.end(), same)) jumping_.push_back(std::move(wave));
  }
}

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
  if (!orbit_.stacking().system(segment.island).is_static()) of_island_[segment.island].push_back(segments_.size());
  segments_.push_back({segment.island, segment.mode, segment.begin, segment.length, &segment.y0, &segment.y1});
  length_ = std::max(length_, segments_.back().end());
}

void Sensitivity::add_static_parts() {
  static_first_ = segments_.size();
  length_ = std::max(length_, orbit_.period());
  const double near = tolerance::same_instant * length_;
  for (std::size_t island = 0; island < of_island_.size(); ++island) {
    const System& system = orbit_.stacking().system(island);
    if (!system.is_static() || trace_.steps.empty()) continue;
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
      if (reads && drive.signal < 0 && stores_[island].count(drive.store) == 0) return "it acts on another part of the circuit";
      const bool gives = drive.signal >= 0 &&
                         std::find(system.output_signal.begin(), system.output_signal.end(), drive.signal) != system.output_signal.end();
      if (gives && !reads) return "it acts on another part of the circuit";
    }
  if (has_unknown_derivatives(own)) return "something follows more derivatives of what it moves than are known";
  return "";
}

/// Whether more derivatives of what a parameter moves count than the inputs have states for, and are not zero.
bool Sensitivity::has_unknown_derivatives(const ParameterInputs& parameter) const {
  const auto is_read_so = [&](const auto& part) { return read_to_the_last_[static_cast<std::size_t>(part.input)] != 0; };
  const auto has_many = [](const Wave& wave) { return !(wave_row(wave) * wave_generator(wave) * wave_generator(wave)).isZero(0.0); };
  return std::any_of(parameter.drives.begin(), parameter.drives.end(), is_read_so) ||
         std::any_of(parameter.waves.begin(), parameter.waves.end(), [&](const Wave& wave) { return is_read_so(wave) && has_many(wave); });
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
    const auto row = [&](int order, double scale) { return Eigen::RowVectorXd(scale * flow.derivative(k, order)); };
    column.each(mode.flow.a().topRows(n1), n1,
                [&](int order, double scale) { drive += mode.flow.a().col(n1 + column.value + order).head(n1) * row(order, scale); });
    column.each(mode.outputs, n1,
                [&](int order, double scale) { flow.outputs += mode.outputs.col(n1 + column.value + order) * row(order, scale); });
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

Eigen::RowVectorXd Sensitivity::Flow::derivative(std::size_t input, int order) const {
  Eigen::RowVectorXd row = rows[input];
  for (int k = 0; k < order; ++k) row = row * source;
  return row;
}

/// Σ (column of the derivative)·w^(k) from `first` on.
Vector Sensitivity::inputs_of(const Flow& flow, std::size_t island, const Matrix& columns, int first, const Vector& yz) const {
  Vector sum = Vector::Zero(columns.rows());
  Derivatives derivative(flow.source, yz);
  for (std::size_t k = 0; k < flow.rows.size(); ++k) {
    if (flow.rows[k].size() == 0) continue;
    const InputColumns& column = orbit_.columns(island, k);
    column.each(columns, first, [&](int order, double scale) {
      sum += columns.col(first + column.value + order) * (scale * flow.rows[k].dot(derivative(order)));
    });
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

}  // namespace pwlsim::steady
