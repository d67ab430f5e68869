/// Functionals that read signals at the points of intervals: the members of Adjoint that add them up by length.
#include <algorithm>
#include <cmath>

#include "linalg/legendre.hpp"
#include "steady/adjoint.hpp"
#include "steady/moments.hpp"
#include "steady/tolerances.hpp"

namespace pwlsim::steady {

using model::Mode;

/// Null where intervals of that length are still few.
Adjoint::Spread* Adjoint::spread_of(const Sensitivity::Segment& segment, double length, Sums& sums) const {
  constexpr int worth = 8;                  // so many intervals
  constexpr std::size_t most_spreads = 32;  // of a mode
  const auto same = [&](const Spread& known) { return std::abs(known.length - length) <= tolerance::same_length * length; };
  auto known = std::find_if(sums.spreads.begin(), sums.spreads.end(), same);
  if (known == sums.spreads.end()) {
    if (sums.spreads.size() == most_spreads) return nullptr;
    sums.spreads.push_back({length, 0, {}, {}});
    known = sums.spreads.end() - 1;
  }
  if (++known->uses < worth) return nullptr;
  if (known->sum.size() == 0) fill(segment, *known);
  return &*known;
}

void Adjoint::fill(const Sensitivity::Segment& segment, Spread& spread) const {
  const Mode& mode = *segment.mode;
  const auto& outputs = shares_[segment.island];
  const auto& rule = linalg::gauss_legendre();
  const auto count = static_cast<Eigen::Index>(outputs.size());
  spread.sum = Matrix::Zero(static_cast<Eigen::Index>(linalg::legendre_points) * count, flow(segment.island, mode).source.rows());
  spread.injection = Matrix::Zero(mode.n1, spread.sum.rows());
  Vector work(2 * mode.n1);
  for (std::size_t i = 0; i < linalg::legendre_points && mode.n1 > 0; ++i)
    for (Eigen::Index k = 0; k < count; ++k) {
      auto column = spread.injection.col(static_cast<Eigen::Index>(i) * count + k);
      column = mode.outputs.row(outputs[static_cast<std::size_t>(k)].first).head(mode.n1).transpose();
      backward_of(mode).apply_once(0.5 * (rule.point[i] + 1.0) * spread.length, column.data(), work.data());
    }
}

/// Null where intervals of about that length are still few.
Adjoint::Range* Adjoint::range_of(const Sensitivity::Segment& segment, double length, Sums& sums) const {
  constexpr int worth = 3 * length_nodes;  // so many intervals
  constexpr std::size_t most_ranges = 16;  // of a mode
  const Mode& mode = *segment.mode;
  if (sums.width < 0.0) {
    const double rate = std::max(mode.flow.rate(), flow(segment.island, mode).signals->rate());
    sums.width = rate > 0.0 ? node_range / rate : 0.0;
  }
  if (sums.width == 0.0) return nullptr;
  const auto number = static_cast<std::int64_t>(std::min(1e18, std::floor(length / sums.width)));
  const auto known = sums.ranges.find(number);
  if (known == sums.ranges.end() && sums.ranges.size() == most_ranges) return nullptr;
  Range& range = sums.ranges[number];
  range.number = number;
  if (++range.uses < worth) return nullptr;
  if (!range.nodes.empty()) return &range;
  const auto begin = static_cast<double>(number) * sums.width;
  const Interpolation between(begin, begin + sums.width);
  for (int j = 0; j < length_nodes; ++j) {
    range.nodes.push_back({between.node(j), 0, {}, {}});
    fill(segment, range.nodes.back());
  }
  return &range;
}

Vector Adjoint::weights_of(std::size_t island, const Functional::Interval& interval) const {
  const auto& outputs = shares_[island];
  Vector weights(static_cast<Eigen::Index>(linalg::legendre_points * outputs.size()));
  Eigen::Index at = 0;
  for (std::size_t i = 0; i < linalg::legendre_points; ++i)
    for (const auto& output : outputs) weights[at++] = interval.weights[i * signals_.size() + output.second];
  return weights;
}

void Adjoint::settle(std::size_t island, const Mode& mode, const Spread& spread, Sums& sums) const {
  const auto& outputs = shares_[island];
  const auto& rule = linalg::gauss_legendre();
  const Sensitivity::Flow& own = flow(island, mode);
  const auto count = static_cast<Eigen::Index>(outputs.size());
  const Matrix a = mode.flow.a().topLeftCorner(mode.n1, mode.n1);
  const auto time_of = [&](std::size_t i) { return 0.5 * (rule.point[i] + 1.0) * spread.length; };
  const auto to_time = [&](double time) {
    Matrix e = own.signals->minus_identity(time);
    e.diagonal().array() += 1.0;
    return e;
  };
  Matrix lambda = Matrix::Zero(mode.n1, spread.sum.cols());  // λ (y, z)′, (y, z) at the begin
  Matrix at = to_time(time_of(linalg::legendre_points - 1));
  for (std::size_t i = linalg::legendre_points; i-- > 0;) {
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::Index row = outputs[static_cast<std::size_t>(k)].first;
      const auto weights = spread.sum.row(static_cast<Eigen::Index>(i) * count + k);
      lambda += mode.outputs.row(row).head(mode.n1).transpose() * weights;
      sums.outputs.row(row) += weights * at.transpose();
    }
    const double before = i > 0 ? time_of(i - 1) : 0.0, length = time_of(i) - before;
    at = to_time(before);
    if (mode.n1 == 0) continue;
    sums.moment += moment_of(a, own.source, lambda * at.transpose(), length, std::max(mode.flow.rate(), own.signals->rate()));
    Vector work(2 * mode.n1);
    for (Eigen::Index k = 0; k < lambda.cols(); ++k) backward_of(mode).apply(length, lambda.col(k).data(), work.data());
  }
}
void Adjoint::take_interval(const Functional::Interval& interval, Pass& pass, Injections& injections) const {
  for (std::size_t island = 0; island < along_.model_.islands.size(); ++island) {
    const Sensitivity::Segment* const segment = shares_[island].empty() ? nullptr : along_.segment_at(island, interval.inside, Side::right);
    if (segment == nullptr) continue;
    const double since = std::max(interval.begin - segment->begin, 0.0);
    Sums& sums = sums_of(pass, island, *segment->mode);
    Injection& injection = injections[static_cast<std::size_t>(segment - along_.segments_.data())].emplace_back();
    injection.since = since;
    if (Spread* const spread = spread_of(*segment, interval.length, sums)) {
      const Vector weights = weights_of(island, interval);
      if (pass.collects) spread->sum.noalias() += weights * later(*segment, begin_of(*segment), since).transpose();
      injection.weight = spread->injection * weights;
    } else if (Range* const range = range_of(*segment, interval.length, sums)) {
      injection.weight = of_range(*segment, interval, since, sums.width, *range, pass.collects);
    } else {
      injection.weight = point_by_point(*segment, interval, since, sums, pass);
    }
  }
}

/// λ that the interval adds at its begin: between those of the range's nodes.
Vector Adjoint::of_range(const Sensitivity::Segment& segment, const Functional::Interval& interval, double since, double width,
                         Range& range, bool collects) const {
  const Vector weights = weights_of(segment.island, interval), yz = later(segment, begin_of(segment), since);
  const auto begin = static_cast<double>(range.number) * width;
  const auto shares = Interpolation(begin, begin + width).weights(interval.length);
  Vector lambda = Vector::Zero(segment.mode->n1);
  for (std::size_t j = 0; j < shares.size(); ++j) {
    Spread& node = range.nodes[j];
    const Vector own = shares[j] * weights;
    if (collects) node.sum.noalias() += own * yz.transpose();
    lambda.noalias() += node.injection * own;
  }
  return lambda;
}

/// The same without anything that is known of its length.
Vector Adjoint::point_by_point(const Sensitivity::Segment& segment, const Functional::Interval& interval, double since, Sums& sums,
                               Pass& pass) const {
  const auto& rule = linalg::gauss_legendre();
  const Mode& mode = *segment.mode;
  std::vector<Vector> yz{later(segment, begin_of(segment), since)};  // at the begin, then at each point
  std::vector<double> length;
  double before = 0.0;
  for (const double point : rule.point) {
    const double at = 0.5 * (point + 1.0) * interval.length;
    length.push_back(at - before);
    yz.push_back(later(segment, yz.back(), length.back()));
    before = at;
  }
  Vector lambda = Vector::Zero(mode.n1);
  for (std::size_t i = length.size(); i-- > 0;) {
    for (const auto& [row, signal] : shares_[segment.island]) {
      const double weight = interval.weights[i * signals_.size() + signal];
      if (weight == 0.0) continue;
      lambda += weight * mode.outputs.row(row).head(mode.n1).transpose();
      sums.outputs.row(row) += weight * yz[i + 1].transpose();
    }
    travel(segment, length[i], yz[i], lambda, pass);
  }
  return lambda;
}

}  // namespace pwlsim::steady
