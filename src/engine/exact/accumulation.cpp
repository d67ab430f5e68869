#include "engine/exact/accumulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/exact/tolerances.hpp"

namespace pwlsim::engine {

namespace {

constexpr int longest_period = 6;
constexpr int shrinking_intervals = 8;  ///< in a row, before it is called an accumulation
constexpr double largest_ratio = 0.95;

}  // namespace

bool AccumulationWatch::Limit::is_near(double at) const {
  const double ahead = time - at;
  if (!(ahead > 0.0) || uncertainty > tolerance::known_limit * ahead) return false;
  const bool known_exactly = uncertainty <= tolerance::limit * time;
  // Nearer to it the events would have no digits. It is known as well as it has to be from nearer on.
  const bool is_last = doubt > tolerance::lost_event * last && uncertainty <= tolerance::known_limit * tolerance::last_crossing * span;
  return ahead <= (known_exactly || is_last ? tolerance::crossing : tolerance::last_crossing) * span;
}

Remark AccumulationWatch::remark(const Limit& limit, const std::vector<std::string>& names, double least) const {
  return {"N-accumulation",
          fmt::format("events accumulate at t = {} s in the part with {}: after {} of them, with each group of {} taking "
                      "{:.6g} of the time of the one before, the run continues from their limit (known to {:.1g} s)",
                      limit.time, fmt::join(names, ", "), events(), limit.period, limit.ratio, std::max(limit.uncertainty, least))};
}

void AccumulationWatch::note(double time, std::uintptr_t mode, const double* x, int n, double doubt) {
  if (events_.empty()) events_.resize(kept);
  Event& event = events_[count_++ % kept];
  event.time = time;
  event.doubt = doubt;
  event.mode = mode;
  event.xi = Eigen::Map<const linalg::Vector>(x, n);
}

/// Of the interval that ends at event −i to the one before.
double AccumulationWatch::ratio(int period, int i) const {
  const double last = back(i).time - back(i + period).time;
  const double before = back(i + period).time - back(i + 2 * period).time;
  return before > 0.0 ? last / before : 1.0;
}

bool AccumulationWatch::repeats(int period) const {
  const int needed = shrinking_intervals + 2 * period;
  if (count_ < static_cast<std::uint64_t>(needed)) return false;
  double least = INFINITY, largest = 0.0;
  for (int i = 0; i < shrinking_intervals; ++i) {
    if (back(i).mode != back(i + period).mode) return false;
    const double r = ratio(period, i);
    least = std::min(least, r);
    largest = std::max(largest, r);
  }
  return largest < largest_ratio && largest - least <= tolerance::ratio_spread * largest;
}

double AccumulationWatch::limit_time(int period, int i) const {
  const double r = ratio(period, i);
  return back(i).time + (back(i).time - back(i + period).time) * r / (1.0 - r);
}

std::optional<AccumulationWatch::Limit> AccumulationWatch::limit() {
  for (int p = 1; p <= longest_period; ++p) {
    if (!repeats(p)) continue;
    Limit limit;
    limit.period = p;
    limit.ratio = ratio(p, 0);
    limit.time = limit_time(p, 0);
    if (!shrinking_) begin_ = back(shrinking_intervals + 2 * p - 1).time;
    shrinking_ = true;
    limit.span = limit.time - begin_;
    limit.last = back(0).time - back(p).time;
    for (int i = 0; i < p; ++i) limit.doubt = std::max(limit.doubt, back(i).doubt);
    limit.uncertainty = std::abs(limit.time - limit_time(p, p));
    const auto& last = back(0).xi;
    const auto& before = back(p).xi;
    const auto& earlier = back(2 * p).xi;
    limit.xi = last;
    for (Eigen::Index i = 0; i < last.size(); ++i) {
      const double change = last[i] - before[i];
      const double r = change / (before[i] - earlier[i]);
      if (std::abs(change) > tolerance::converged_state * std::abs(last[i]) && std::abs(r) < largest_ratio)
        limit.xi[i] += change * r / (1.0 - r);
    }
    return limit;
  }
  shrinking_ = false;
  return std::nullopt;
}

}  // namespace pwlsim::engine
