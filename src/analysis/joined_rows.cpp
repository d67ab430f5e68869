#include "analysis/joined_rows.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace pwlsim::analysis {
namespace {

using Rows = waveform::ThinnedRows::Rows;

/// Every time as often as the run has it that has it most often.
std::vector<double> all_times(const std::vector<Rows>& runs) {
  std::vector<double> times;
  for (const Rows& run : runs) {
    std::vector<double> both;
    std::set_union(times.begin(), times.end(), run.times.begin(), run.times.end(), std::back_inserter(both));
    times = std::move(both);
  }
  return times;
}

/// Of one run: which of its rows stand at, or on either side of, each time.
struct Place {
  std::size_t low = 0, high = 0;
  double share = 0.0;  ///< of high
  bool inside = false;
};

std::vector<Place> places_of(const std::vector<double>& own, const std::vector<double>& times) {
  std::vector<Place> places;
  std::size_t next = 0;  // first own row that is not yet passed
  for (const double time : times) {
    const bool has_row = next < own.size() && own[next] == time;
    if (has_row) {
      places.push_back({next, next, 0.0, true});
      ++next;
    } else if (next == 0 || (next == own.size() && own.back() < time)) {
      places.push_back({});
    } else if (own[next - 1] == time) {  // another run has more rows here
      places.push_back({next - 1, next - 1, 0.0, true});
    } else {
      places.push_back({next - 1, next, (time - own[next - 1]) / (own[next] - own[next - 1]), true});
    }
  }
  return places;
}

}  // namespace

JoinedRows join_rows(const std::vector<Rows>& runs) {
  JoinedRows joined{all_times(runs)};
  for (const Rows& run : runs) {
    const std::vector<Place> places = places_of(run.times, joined.times);
    auto& columns = joined.columns.emplace_back();
    for (const std::vector<double>& values : run.columns) {
      auto& column = columns.emplace_back();
      for (const Place& place : places)
        column.push_back(place.inside ? std::lerp(values[place.low], values[place.high], place.share)
                                      : std::numeric_limits<double>::quiet_NaN());
    }
  }
  return joined;
}

}  // namespace pwlsim::analysis
