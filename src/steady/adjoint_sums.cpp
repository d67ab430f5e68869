/// What the inputs of parameters bring: the members of Adjoint that settle its sums, and read them.
#include <algorithm>
#include <array>
#include <cmath>

#include "steady/adjoint.hpp"
#include "steady/moments.hpp"

namespace pwlsim::steady {

using model::Mode;

void Adjoint::settle(std::size_t island, const Mode& mode, Sums& sums, Pass& pass) const {
  const Matrix own = mode.flow.a().topLeftCorner(mode.n1, mode.n1);
  const Matrix& source = flow(island, mode).source;
  const double rate = std::max(mode.flow.rate(), flow(island, mode).signals->rate());
  const auto add = [&](const Matrix& sum, double length, int density) {
    if (density < 0) {
      sums.moment += moment_of(own, source, sum, length, rate);
      return;
    }
    const Even& even = pass.even.at({&mode, density});
    const Matrix moment = moment_of(even.a, source, sum, length, std::max(rate, even.backward.rate()));
    sums.moment += moment.topRows(mode.n1);
    for (const auto& [row, weight] : even.outputs) sums.outputs.row(row) += weight / even.scale * moment.row(mode.n1);
  };
  std::vector<Lengths>& list = sums.lengths;
  std::sort(list.begin(), list.end(),
            [](const Lengths& a, const Lengths& b) { return std::pair(a.density, a.length) < std::pair(b.density, b.length); });
  for (std::size_t first = 0, last = 0; first < list.size(); first = last) {
    const int density = list[first].density;
    const auto is_near = [&](const Lengths& each) {
      return each.density == density && (each.length - list[first].length) * rate <= node_range;
    };
    for (last = first + 1; last < list.size() && is_near(list[last]);) ++last;
    if (last - first <= length_nodes) {
      for (std::size_t k = first; k < last; ++k) add(list[k].sum, list[k].length, density);
      continue;
    }
    const Interpolation between(list[first].length, list[last - 1].length);
    std::array<Matrix, length_nodes> sum;
    for (std::size_t k = first; k < last; ++k) {
      const auto shares = between.weights(list[k].length);
      for (std::size_t j = 0; j < shares.size(); ++j)
        if (k == first)
          sum[j] = shares[j] * list[k].sum;
        else
          sum[j] += shares[j] * list[k].sum;
    }
    for (int j = 0; j < length_nodes; ++j) add(sum[static_cast<std::size_t>(j)], between.node(j), density);
  }
  list.clear();
}

/// What the inputs of one parameter bring, by the sums of all modes.
double Adjoint::of_parameter(std::size_t parameter, Pass& pass) const {
  double total = 0.0;
  for (const auto& entry : pass.sums) {
    const std::size_t island = entry.first.first;
    const Mode& mode = *entry.first.second;
    const Sums& sums = entry.second;
    Sensitivity::Flow own;
    along_.add_drives(parameter, island, mode, own);
    const int first_wave = own.ny + along_.first_of_waves(parameter, island);
    const Eigen::Index n1 = mode.n1, n = along_.orbit_.stacking().count(island);
    const auto of_column = [&](int column) {
      Eigen::RowVectorXd weight = mode.outputs.col(n1 + column).transpose() * sums.outputs;
      if (n1 > 0) weight += mode.flow.a().col(n1 + column).head(n1).transpose() * sums.moment;
      if (mode.constrained) {
        weight += mode.projector.col(n + column).head(n).transpose() * sums.jump;
        weight += mode.lift.col(column).transpose() * sums.lift;
      }
      return weight;
    };
    const auto dot = [&](const Eigen::RowVectorXd& weight, const Eigen::RowVectorXd& row) {
      return weight.head(own.ny).dot(row.head(own.ny)) + weight.segment(first_wave, own.nz).dot(row.tail(own.nz));
    };
    for (std::size_t k = 0; k < own.rows.size(); ++k) {
      if (own.rows[k].size() == 0) continue;
      const InputColumns& column = along_.orbit_.columns(island, k);
      const auto row = static_cast<Eigen::Index>(k);
      Eigen::RowVectorXd derivative = own.rows[k];
      double scale = 1.0;
      for (int order = 0; order < column.count && !derivative.isZero(0.0);
           ++order, scale /= column.rate, derivative = derivative * own.source) {
        Eigen::RowVectorXd weight = scale * of_column(column.value + order);
        if (order < static_cast<int>(sums.inputs.size())) weight += sums.inputs[static_cast<std::size_t>(order)].row(row);
        total += dot(weight, derivative);
      }
    }
  }
  return total;
}

/// Edges, clocks and thresholds that move.
double Adjoint::of_edges(std::size_t parameter, const Pass& pass) const {
  const ParameterInputs& own = along_.inputs_.parameters[parameter];
  if (own.waves.empty() && own.levels.empty() && own.drives.empty()) return 0.0;
  double total = 0.0;
  Followed scratch;
  for (const auto& [i, weight] : pass.read) {
    const LinearInstant& instant = along_.orbit_.instants()[i];
    if (!along_.edge_shift_of(parameter, instant.time, scratch)) total += weight * along_.corner_shift_of(parameter, instant);
  }
  for (std::size_t i = 0; i < pass.shifts.size(); ++i) {
    if (pass.shifts[i] == 0.0) continue;
    const LinearInstant& instant = along_.orbit_.instants()[i];
    if (const auto edge = along_.edge_shift_of(parameter, instant.time, scratch)) {
      total += pass.shifts[i] * *edge;
      continue;
    }
    total += pass.shifts[i] * along_.level_shift_of(parameter, instant);
    if (instant.island < 0) total += pass.shifts[i] * along_.clock_shift_of(parameter, instant, instant.time);
  }
  return total;
}

}  // namespace pwlsim::steady
