/// Diodes that carry and block nothing for a while: the members of Sensitivity that find them, and what a parameter makes of them.
///
/// Where u_i = y_i = 0 throughout a segment, the diode's guard g is zero there, and its derivative g_p decides: for p + dp, dp·g_p > 0, the mode goes on, and the
/// derivative is that of the mode. On the other side the diode conducts where it blocked, or blocks where it conducted, and there is another derivative.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "steady/sensitivity.hpp"
#include "steady/tolerances.hpp"

namespace pwlsim::steady {
namespace {

using model::Mode;

}  // namespace

void Sensitivity::find_rests(std::size_t number) {
  const Segment& segment = segments_[number];
  const Mode& mode = *segment.mode;
  const int diodes = orbit_.stacking().system(segment.island).diodes;
  if (diodes == 0 || !(segment.length > 0.0)) return;
  const auto is_zero = [&](int row, const std::vector<double>& y) {
    return std::abs(linalg::row_times(mode.guards, row, y.data())) <=
           tolerance::resting_guard * linalg::absolute_row_times(mode.guards, row, y.data());
  };
  for (int row = 0; row < diodes; ++row) {
    const bool is_unique = mode.input_unique.empty() || mode.input_unique[static_cast<std::size_t>(row)] != 0;
    if (!is_unique || !is_zero(row, *segment.y0) || !is_zero(row, *segment.y1)) continue;
    constexpr std::array<double, 3> places{0.21, 0.5, 0.83};  // in no rhythm: a sine has no zero at all of them
    const bool rests = std::all_of(places.begin(), places.end(), [&](double place) {
      std::vector<double> y = *segment.y0, work(2 * y.size());
      mode.flow.apply_once(place * segment.length, y.data(), work.data());
      return is_zero(row, y);
    });
    if (rests) rests_[number].push_back(row);
  }
}

void Sensitivity::check_rests(std::size_t parameter, std::size_t number, Followed& followed) const {
  const auto rests = rests_.find(number);
  if (rests == rests_.end() || !followed.failure.empty()) return;
  const Segment& segment = segments_[number];
  const Mode& mode = *segment.mode;
  const Flow& flow = flow_of(parameter, segment.island, mode);
  for (const double place : {0.0, 0.5, 1.0}) {
    const Vector state = at(flow, segment, followed.begins[number], place * segment.length);
    const Vector c = state.tail(mode.n1) * flow.scale;
    Derivatives derivative(flow.source, state.head(flow.ny + flow.nz));
    for (const int row : rests->second) {
      double moved = 0.0, size = 0.0;
      const auto add = [&](double weight, double value) {
        moved += weight * value;
        size += std::abs(weight * value);
      };
      for (Eigen::Index i = 0; i < mode.n1; ++i) add(mode.guards(row, i), c[i]);
      for (std::size_t k = 0; k < flow.rows.size(); ++k) {
        if (flow.rows[k].size() == 0) continue;
        const InputColumns& column = orbit_.columns(segment.island, k);
        column.each(mode.guards.row(row), mode.n1, [&](int order, double scale) {
          add(mode.guards(row, mode.n1 + column.value + order), scale * flow.rows[k].dot(derivative(order)));
        });
      }
      if (std::abs(moved) <= tolerance::resting_slope * size) continue;
      followed.fail(fmt::format("{} carries and blocks nothing from t = {} s on, and the parameter decides which it does",
                                orbit_.stacking().system(segment.island).port[static_cast<std::size_t>(row)].name, segment.begin),
                    true);
    }
  }
}

Followed Sensitivity::follow_to_last_rest(std::size_t parameter, const Vector& start) const {
  return follow(parameter, start, rests_.empty() ? 0 : rests_.rbegin()->first + 1);
}

}  // namespace pwlsim::steady
