#include "steady/adjoint.hpp"
#include "steady/tolerances.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "steady/moments.hpp"

namespace pwlsim::steady {
namespace {

using engine::Change;
using model::Mode;

constexpr std::size_t least_kept = 48, most_kept = 512;  ///< lengths of one mode, before their sums are settled
constexpr std::size_t entries_kept = 200'000;            ///< of the matrices of these

std::size_t most_lengths(Eigen::Index rows, Eigen::Index columns) {
  const auto entries = static_cast<std::size_t>(std::max<Eigen::Index>(1, rows * columns));
  return std::clamp(entries_kept / entries, least_kept, most_kept);
}
}  // namespace

Adjoint::Adjoint(const Sensitivity& sensitivity, std::vector<int> signals) : along_(sensitivity), signals_(std::move(signals)) {
  const std::size_t count = along_.inputs_.parameters.size();
  failures_.resize(count);
  forward_only_.assign(count, 0);
  kinks_.assign(count, 0);
  for (std::size_t p = 0; p < count; ++p) examine(p);
  for (std::size_t island = 0; island < along_.model_.islands.size(); ++island) shares_.push_back(along_.shares_of(island, signals_));
}

namespace {

/// Whether a parameter may move an instant's guards apart: those that read the same go together, but for their thresholds.
bool may_part(const ParameterInputs& own, const LinearInstant& instant) {
  const auto moves_level = [&](const LinearGuard& guard) {
    return std::any_of(own.levels.begin(), own.levels.end(), [&](const LevelMove& level) { return level.number == guard.level_switch; });
  };
  const auto agree = [](double a, double b) { return std::abs(a - b) <= tolerance::same_guard * (std::abs(a) + std::abs(b)); };
  return std::any_of(instant.beside.begin(), instant.beside.end(), [&](const LinearGuard& guard) {
    return guard.island != instant.island || moves_level(guard) || moves_level(instant) ||
           !guard.on_state.isApprox(instant.on_state, tolerance::same_guard) ||
           !std::equal(guard.on_w.begin(), guard.on_w.end(), instant.on_w.begin(), instant.on_w.end(), agree) ||
           !std::equal(guard.on_slope.begin(), guard.on_slope.end(), instant.on_slope.begin(), instant.on_slope.end(), agree) ||
           !std::equal(guard.on_derivatives.reshaped().begin(), guard.on_derivatives.reshaped().end(),
                       instant.on_derivatives.reshaped().begin(), instant.on_derivatives.reshaped().end(), agree);
  });
}

}  // namespace

void Adjoint::examine(std::size_t parameter) {
  Followed scratch;
  scratch.failure = along_.check(parameter);
  const ParameterInputs& own = along_.inputs_.parameters[parameter];
  forward_only_[parameter] = !own.waves.empty() && !own.levels.empty();
  for (std::size_t i = 0; i < along_.orbit_.instants().size() && scratch.failure.empty(); ++i) {
    const LinearInstant& instant = along_.orbit_.instants()[i];
    along_.check_changes(i, scratch);
    if (may_part(own, instant)) forward_only_[parameter] = 1;
    if (own.waves.empty() || !scratch.failure.empty()) continue;
    const auto edge = along_.edge_shift_of(parameter, instant.time, scratch);
    if (!edge) continue;
    if (*edge != 0.0) along_.check_others(parameter, instant, scratch);
    if (instant.island >= 0) forward_only_[parameter] = 1;
  }
  failures_[parameter] = scratch.failure;
  kinks_[parameter] = scratch.is_kink ? 1 : 0;
}

const Sensitivity::Flow& Adjoint::flow(std::size_t island, const Mode& mode) const {
  return along_.flow_of(along_.inputs_.parameters.size(), island, mode);
}

Adjoint::Sums& Adjoint::sums_of(Pass& pass, std::size_t island, const Mode& mode) const {
  Sums& sums = pass.sums[{island, &mode}];
  if (!sums.inputs.empty()) return sums;
  const Eigen::Index width = flow(island, mode).source.rows(), n = along_.orbit_.stacking().count(island);
  sums.moment = Matrix::Zero(mode.n1, width);
  sums.outputs = Matrix::Zero(mode.outputs.rows(), width);
  sums.jump = sums.lift = Matrix::Zero(n, width);
  sums.inputs.assign(1, Matrix::Zero(static_cast<Eigen::Index>(along_.orbit_.inputs()), width));
  return sums;
}

Vector Adjoint::signals_of(std::size_t island, const Mode& mode, const double* y, double time, double inside) const {
  const Sensitivity::Flow& own = flow(island, mode);
  Vector yz(own.ny + own.nz);
  yz << along_.seen(island, mode, y), along_.waves_at(own, along_.inputs_.parameters.size(), time, inside);
  return yz;
}

/// (y, z) at the begin of a segment.
const Vector& Adjoint::begin_of(const Sensitivity::Segment& segment) const {
  if (begins_.empty()) begins_.resize(along_.segments_.size());
  Vector& known = begins_[static_cast<std::size_t>(&segment - along_.segments_.data())];
  if (known.size() == 0) known = signals_of(segment.island, *segment.mode, segment.y0->data(), segment.begin, segment.inside());
  return known;
}

Vector Adjoint::later(const Sensitivity::Segment& segment, Vector yz, double since) const {
  if (!(since > 0.0)) return yz;
  const linalg::Exponential& block = *flow(segment.island, *segment.mode).signals;
  Vector work(2 * yz.size());
  block.apply(since, yz.data(), work.data());
  return yz;
}

/// Where stretches overlap their weights add up.
void Adjoint::take_stretches(const Functional& functional, Pass& pass) const {
  std::vector<double> ends;
  for (const Functional::Stretch& stretch : functional.stretches) ends.insert(ends.end(), {stretch.begin, stretch.end});
  std::sort(ends.begin(), ends.end());
  for (std::size_t k = 1; k < ends.size(); ++k) {
    if (!(ends[k - 1] < ends[k])) continue;
    Pass::Density density{ends[k - 1], ends[k], std::vector<double>(signals_.size(), 0.0)};
    for (const Functional::Stretch& stretch : functional.stretches)
      if (stretch.begin <= density.begin && density.end <= stretch.end)
        for (std::size_t j = 0; j < signals_.size(); ++j) density.weights[j] += stretch.weights[j];
    pass.densities.push_back(std::move(density));
  }
}

const Adjoint::Even& Adjoint::even_of(const Sensitivity::Segment& segment, int density, Pass& pass) const {
  const Mode& mode = *segment.mode;
  const auto known = pass.even.find({&mode, density});
  if (known != pass.even.end()) return known->second;
  Even& even = pass.even[{&mode, density}];
  const Eigen::Index n = mode.n1;
  Eigen::RowVectorXd c = Eigen::RowVectorXd::Zero(n);
  for (const auto& [row, signal] : shares_[segment.island]) {
    const double weight = pass.densities[static_cast<std::size_t>(density)].weights[signal];
    if (weight == 0.0) continue;
    even.outputs.emplace_back(row, weight);
    c += weight * mode.outputs.row(row).head(n);
  }
  const double rate = mode.flow.rate(), size = c.norm();
  if (size > 0.0) even.scale = rate > 0.0 ? size / rate : size;
  even.a = Matrix::Zero(n + 1, n + 1);
  even.a.topLeftCorner(n, n) = mode.flow.a().topLeftCorner(n, n);
  even.a.bottomLeftCorner(1, n) = c / even.scale;
  even.backward = linalg::Exponential(even.a.transpose(), rate > 0.0 ? 2.0 * rate : 1e-30);
  return even;
}

void Adjoint::cross(const Sensitivity::Segment& segment, double since, double end, const Vector& begin, Vector& lambda, Pass& pass) const {
  // From the last density that begins before the end, down to `since`.
  auto after = std::partition_point(pass.densities.begin(), pass.densities.end(),
                                    [&](const Pass::Density& d) { return d.begin < segment.begin + end; });
  const auto go = [&](double from, int density) {
    if (!(from < end)) return;
    travel(segment, end - from, later(segment, begin, from), lambda, pass, density);
    end = from;
  };
  while (after != pass.densities.begin() && !shares_[segment.island].empty()) {
    const Pass::Density& density = *--after;
    if (!(density.end > segment.begin + since)) break;
    go(std::max(since, density.end - segment.begin), -1);
    go(std::max(since, density.begin - segment.begin), static_cast<int>(after - pass.densities.begin()));
  }
  go(since, -1);
}

/// Back over an interval that begins with (y, z).
void Adjoint::travel(const Sensitivity::Segment& segment, double length, const Vector& yz, Vector& lambda, Pass& pass, int density) const {
  const Mode& mode = *segment.mode;
  const Even* const even = density >= 0 ? &even_of(segment, density, pass) : nullptr;
  const bool has_density = even != nullptr && !even->outputs.empty();
  if ((mode.n1 == 0 && !has_density) || !(length > 0.0)) return;
  if (!has_density) density = -1;
  const Eigen::Index n = mode.n1;
  Vector state(n + 1);
  state << lambda, even != nullptr ? even->scale : 1.0;
  if (pass.collects) {
    Sums& sums = sums_of(pass, segment.island, mode);
    const auto same = [&](const Lengths& known) {
      return known.density == density && std::abs(known.length - length) <= tolerance::same_length * length;
    };
    auto known = std::find_if(sums.lengths.begin(), sums.lengths.end(), same);
    if (known == sums.lengths.end()) {
      if (sums.lengths.size() == most_lengths(n + 1, yz.size())) settle(segment.island, mode, sums, pass);
      sums.lengths.push_back({length, density, Matrix::Zero(has_density ? n + 1 : n, yz.size())});
      known = sums.lengths.end() - 1;
    }
    known->sum.noalias() += state.head(known->sum.rows()) * yz.transpose();
  }
  if (n == 0) return;
  Vector work(2 * state.size());
  if (has_density) {
    even->backward.apply(length, state.data(), work.data());
    lambda = state.head(n);
    return;
  }
  backward_of(mode).apply(length, lambda.data(), work.data());
}

const linalg::Exponential& Adjoint::backward_of(const Mode& mode) const {
  auto back = backward_.find(&mode);
  if (back == backward_.end())
    back = backward_.emplace(&mode, linalg::Exponential(mode.flow.a().topLeftCorner(mode.n1, mode.n1).transpose(), mode.flow.rate())).first;
  return back->second;
}
void Adjoint::take_points(const Functional& functional, Pass& pass, Injections& injections) const {
  for (const Functional::Point& point : functional.points)
    for (std::size_t island = 0; island < along_.model_.islands.size(); ++island) {
      const auto& outputs = shares_[island];
      const Sensitivity::Segment* const segment = outputs.empty() ? nullptr : along_.segment_at(island, point.time, point.side);
      if (segment == nullptr) continue;
      const Mode& mode = *segment->mode;
      const double since = std::clamp(point.time - segment->begin, 0.0, segment->length);
      const Vector yz = later(*segment, begin_of(*segment), since), rate = flow(island, mode).source * yz;
      const Matrix a = mode.flow.a().topLeftCorner(mode.n1, mode.n1);
      Vector weight = Vector::Zero(mode.n1), of_rate = Vector::Zero(mode.n1);
      Sums& sums = sums_of(pass, island, mode);
      for (const auto& [row, signal] : outputs) {
        const double moved = point.moved.empty() ? 0.0 : point.moved[signal], rates = point.rates.empty() ? 0.0 : point.rates[signal];
        weight += moved * mode.outputs.row(row).head(mode.n1).transpose();
        of_rate += rates * mode.outputs.row(row).head(mode.n1).transpose();
        sums.outputs.row(row) += moved * yz.transpose() + rates * rate.transpose();
      }
      sums.moment += of_rate * yz.transpose();
      injections[static_cast<std::size_t>(segment - along_.segments_.data())].push_back({since, weight + a.transpose() * of_rate});
    }
}
void Adjoint::pass_segment(std::size_t number, Injections& injections, Pass& pass) const {
  const Sensitivity::Segment& segment = along_.segments_[number];
  const Mode& mode = *segment.mode;
  const Stacking& stacking = along_.orbit_.stacking();
  if (stacking.count(segment.island) == 0) {
    Vector none;
    // Parts that hold nothing but sources have segments of their own, behind those of the run.
    const bool has_own = number < along_.static_first_ && stacking.system(segment.island).ports == 0;
    if (!has_own && !pass.densities.empty() && !shares_[segment.island].empty())
      cross(segment, 0.0, segment.length, begin_of(segment), none, pass);
    return;
  }
  auto block = pass.lambda.segment(stacking.first(segment.island), stacking.count(segment.island));
  const Vector& begin = begin_of(segment);
  if (mode.constrained && pass.collects)
    sums_of(pass, segment.island, mode).lift.noalias() += block * later(segment, begin, segment.length).transpose();
  Vector lambda = mode.constrained ? Vector(mode.basis.transpose() * block) : Vector(block);
  double end = segment.length;
  if (const auto own = injections.find(number); own != injections.end()) {
    std::vector<Injection>& list = own->second;
    std::stable_sort(list.begin(), list.end(), [](const Injection& a, const Injection& b) { return a.since > b.since; });
    for (const Injection& injection : list) {
      if (injection.since < end) cross(segment, injection.since, end, begin, lambda, pass);
      end = std::min(end, injection.since);
      lambda += injection.weight;
    }
  }
  cross(segment, 0.0, end, begin, lambda, pass);
  if (mode.constrained)
    block = mode.basis * lambda;
  else
    block = lambda;
}

void Adjoint::pass_instant(std::size_t number, const Functional& functional, Pass& pass) const {
  const LinearInstant& instant = along_.orbit_.instants()[number];
  const Stacking& stacking = along_.orbit_.stacking();
  const double time = instant.time, left = time - tolerance::same_instant * (along_.length_ + time),
               right = time + tolerance::same_instant * (along_.length_ + time);
  const auto read = functional.shifts.find(number);
  double sigma = read != functional.shifts.end() ? read->second : 0.0;
  const auto& changes = along_.trace_.steps[number].changes;
  for (std::size_t k = changes.size(); k-- > 0;) {
    const Change& change = changes[k];
    const int n = stacking.count(change.island);
    if (n == 0) continue;
    if (instant.changes[k].d.size() > 0) sigma += instant.changes[k].d.dot(pass.lambda.segment(stacking.first(change.island), n));
    pass_ways(change, time, right, pass);
  }
  pass.shifts[number] = sigma;
  if (instant.island < 0 || sigma == 0.0) return;
  const auto island = static_cast<std::size_t>(instant.island);
  pass.lambda.segment(stacking.first(island), stacking.count(island)) += sigma * instant.on_state.transpose();
  if (!pass.collects) return;
  const auto own = std::find_if(changes.begin(), changes.end(),
                                [&](const Change& change) { return change.island == island && change.before != nullptr; });
  if (own != changes.end()) collect_guard(*own, instant, left, sigma, pass);
}

/// Back through the jumps of an island at an instant.
void Adjoint::pass_ways(const Change& change, double time, double right, Pass& pass) const {
  const Stacking& stacking = along_.orbit_.stacking();
  const int n = stacking.count(change.island);
  auto block = pass.lambda.segment(stacking.first(change.island), n);
  const std::vector<Vector> ways = along_.states_by_way(change);
  for (std::size_t w = change.by_way_of.size(); w-- > 0;) {
    const Mode& mode = *change.by_way_of[w];
    if (!mode.constrained) continue;
    if (pass.collects) {
      const Vector yz = signals_of(change.island, mode, ways[w].data(), time, right);
      sums_of(pass, change.island, mode).jump.noalias() += block * yz.transpose();
    }
    block = mode.projector.topLeftCorner(n, n).transpose() * Vector(block);
  }
}

/// What the guard whose zero the instant is reads of the inputs.
void Adjoint::collect_guard(const Change& change, const LinearInstant& instant, double left, double sigma, Pass& pass) const {
  const Vector yz = signals_of(change.island, *change.before, change.y_before.data(), instant.time, left);
  Sums& sums = sums_of(pass, change.island, *change.before);
  for (std::size_t k = 0; k < instant.on_w.size(); ++k)
    for (int order = 0; order < instant.derivatives(); ++order) {
      const double on = instant.on_derivative(k, order);
      if (on == 0.0) continue;
      while (static_cast<int>(sums.inputs.size()) <= order)
        sums.inputs.push_back(Matrix::Zero(sums.inputs[0].rows(), sums.inputs[0].cols()));
      sums.inputs[static_cast<std::size_t>(order)].row(static_cast<Eigen::Index>(k)) += sigma * on * yz.transpose();
    }
}

void Adjoint::run(const Functional& functional, const Vector& end, Pass& pass) const {
  pass.lambda = end.size() > 0 ? end : Vector(Vector::Zero(along_.orbit_.stacking().size()));
  pass.shifts.assign(along_.orbit_.instants().size(), 0.0);
  pass.read = functional.shifts;
  Injections injections;
  take_stretches(functional, pass);
  for (std::size_t s = along_.segments_.size(); s-- > along_.static_first_;)
    if (!pass.densities.empty()) pass_segment(s, injections, pass);
  take_points(functional, pass, injections);
  for (const auto& [number, interval] : functional.intervals) take_interval(interval, pass, injections);
  for (std::size_t s = along_.static_first_; s-- > along_.first_.back();) pass_segment(s, injections, pass);
  for (std::size_t i = along_.orbit_.instants().size(); i-- > 0;) {
    pass_instant(i, functional, pass);
    const std::size_t next = i + 1 < along_.first_.size() ? along_.first_[i + 1] : along_.static_first_;
    for (std::size_t s = next; s-- > along_.first_[i];) pass_segment(s, injections, pass);
  }
}

Vector Adjoint::to_start(const Functional& functional, const Vector& end) const {
  Pass pass;
  pass.collects = false;
  run(functional, end, pass);
  return pass.lambda;
}

Adjoint::Read Adjoint::read(const Functional& functional, const Vector& end) const {
  Pass pass;
  run(functional, end, pass);
  for (auto& [key, sums] : pass.sums) {
    settle(key.first, *key.second, sums, pass);
    for (const Spread& spread : sums.spreads)
      if (spread.sum.size() > 0) settle(key.first, *key.second, spread, sums);
    for (const auto& [number, range] : sums.ranges)
      for (const Spread& node : range.nodes) settle(key.first, *key.second, node, sums);
  }
  Read read{{}, pass.lambda};
  for (std::size_t p = 0; p < failures_.size(); ++p)
    read.values.push_back(failures_[p].empty() ? of_parameter(p, pass) + of_edges(p, pass) : 0.0);
  return read;
}

}  // namespace pwlsim::steady
