/// Signals of the run, and their derivatives: the members of Sensitivity that read them.
#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/legendre.hpp"
#include "steady/sensitivity.hpp"
#include "steady/tolerances.hpp"

namespace pwlsim::steady {

using engine::Change;
using model::Mode;

const Sensitivity::Segment* Sensitivity::segment_at(std::size_t island, double time, Side side) const {
  const auto& list = of_island_[island];
  if (list.empty()) return nullptr;
  const double near = tolerance::same_instant * (length_ + time);
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
    const bool is_end = since > 0.0 && segment->length - since <= tolerance::same_instant * tolerance::same_instant * (length_ + time);
    const std::vector<double>& from = is_end ? *segment->y1 : *segment->y0;
    Vector y = Eigen::Map<const Vector>(from.data(), static_cast<Eigen::Index>(from.size())), work(2 * y.size());
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
  for (std::size_t island = 0; island < model_.islands.size(); ++island)
    if (orbit_.stacking().system(island).is_static() && !shares_of(island, signals).empty()) return true;  // such parts have no changes
  for (const Change& change : trace_.steps[instant].changes) {
    const std::vector<Share> shares = shares_of(change.island, signals);
    if (shares.empty()) continue;
    if (change.before == nullptr || change.y_before.empty()) return true;
    const Eigen::Map<const Vector> before(change.y_before.data(), change.before->ny), after(change.y_after.data(), change.after->ny);
    for (const auto& [row, signal] : shares) {
      const double left = change.before->outputs.row(row).dot(before), right = change.after->outputs.row(row).dot(after);
      if (!(std::abs(left - right) <= tolerance::signal_rounding * (std::abs(left) + std::abs(right)))) return true;
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

const Matrix& Sensitivity::Flow::rows_at_points(double length, const Matrix& read) const {
  constexpr int worth_a_matrix = 24;  // so many uses
  const auto& rule = linalg::gauss_legendre();
  Points& at = points[length];
  if (at.rows.size() == 0 && ++at.uses >= worth_a_matrix) {
    at.rows.resize(read.rows() * static_cast<Eigen::Index>(linalg::legendre_points), read.cols());
    for (std::size_t i = 0; i < linalg::legendre_points; ++i)
      at.rows.middleRows(static_cast<Eigen::Index>(i) * read.rows(), read.rows()) =
          read + read * block->minus_identity(0.5 * (rule.point[i] + 1.0) * length);
  }
  return at.rows;
}

std::vector<std::vector<double>> Sensitivity::moved_at(const Followed& followed, std::size_t parameter, const std::vector<int>& signals,
                                                       double inside, double begin, double length) const {
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
    double since = 0.0;
    const Matrix& at_points = flow.rows_at_points(length, rows);
    const Vector all = at_points.size() > 0 ? Vector(at_points * state) : Vector();
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
