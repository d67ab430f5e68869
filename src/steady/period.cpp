#include "steady/period.hpp"
#include "steady/tolerances.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>

namespace pwlsim::steady {
namespace {

using namespace model;

/// The fraction of the least denominator within the rounding of a positive ratio, by continued fractions.
std::optional<Ratio> ratio_of(double ratio) {
  std::int64_t p0 = 0, q0 = 1, p1 = 1, q1 = 0;
  double rest = ratio;
  for (int term = 0; term < 40; ++term) {
    const double whole = std::floor(rest);
    if (whole > 9e15) return std::nullopt;
    const auto a = static_cast<std::int64_t>(whole);
    const std::int64_t p = a * p1 + p0, q = a * q1 + q0;
    if (q > largest_denominator || p > (std::int64_t{1} << 53)) return std::nullopt;
    if (std::abs(static_cast<double>(p) / static_cast<double>(q) - ratio) <= tolerance::ratio_rounding * ratio) return Ratio{p, q};
    p0 = p1, q0 = q1, p1 = p, q1 = q;
    if (rest == whole) return std::nullopt;
    rest = 1.0 / (rest - whole);
  }
  return std::nullopt;
}

/// s; 0: constant, negative: moves and does not repeat.
struct PeriodOf {
  double operator()(const Dc&) const { return 0.0; }
  double operator()(const Held&) const { return 0.0; }
  double operator()(const SmallInput&) const { return 0.0; }
  double operator()(const Sin& f) const {
    if (f.amplitude == 0.0 || (f.frequency == 0.0 && f.damping == 0.0)) return 0.0;
    return f.damping == 0.0 && f.cycles == forever ? 1.0 / f.frequency : -1.0;
  }
  double operator()(const Pulse& f) const {
    if (f.initial == f.pulsed) return 0.0;
    return f.period > 0.0 && f.period < forever && f.cycles == forever ? f.period : -1.0;
  }
  double operator()(const Pwl& f) const {
    const auto moves = [&](const Pwl::Point& point) { return point.value != f.points.front().value; };
    if (std::none_of(f.points.begin(), f.points.end(), moves)) return 0.0;
    const double length = f.points.back().time - f.repeat_from;
    return f.repeats == forever && length > 0.0 ? length : -1.0;
  }
  double operator()(const Exp& f) const { return f.v1 == f.v2 ? 0.0 : -1.0; }
};

/// The function as it would be had it always been periodic, or its last value.
struct Settled {
  SourceFunction operator()(const Dc& f) const { return f; }
  SourceFunction operator()(const Held& f) const { return f; }
  SourceFunction operator()(const SmallInput& f) const { return f; }
  SourceFunction operator()(const Sin& f) const {
    if (PeriodOf{}(f) <= 0.0) return Dc{f.offset + (f.damping > 0.0 && f.cycles == forever ? 0.0 : f.amplitude * std::sin(f.phase))};
    Sin settled = f;
    const double cycles = f.frequency * f.delay;
    settled.delay = 0.0;
    settled.phase = f.phase - 2.0 * std::numbers::pi * (cycles - std::nearbyint(cycles));
    return settled;
  }
  SourceFunction operator()(const Pulse& f) const {
    if (PeriodOf{}(f) <= 0.0) return Dc{f.width < forever || (f.period < forever && f.cycles < forever) ? f.initial : f.pulsed};
    Pulse settled = f;
    settled.delay = f.delay - (std::floor(f.delay / f.period) + 1.0) * f.period;
    return settled;
  }
  SourceFunction operator()(const Pwl& f) const {
    const double period = PeriodOf{}(f);
    if (f.points.empty()) return f;
    if (period <= 0.0) return Dc{f.points.back().value};
    Pwl settled = f;
    const double shift = (std::floor(f.points.back().time / period) + 1.0) * period;
    for (Pwl::Point& point : settled.points) point.time -= shift;
    settled.repeat_from -= shift;
    return settled;
  }
  SourceFunction operator()(const Exp& f) const { return Dc{f.td2 < forever ? f.v1 : f.v2}; }
};

std::string frequency_text(const PeriodicSource& source) { return fmt::format("{} ({:.6g} Hz)", source.name, 1.0 / source.period); }

/// Of the exact values cycles·period the one with the shortest text: what the deck means.
double seconds_of(const std::vector<PeriodicSource>& sources) {
  double best = 0.0;
  std::size_t shortest = 100;
  for (const PeriodicSource& source : sources) {
    const double frequency = 1.0 / source.period;
    for (const double seconds :
         {static_cast<double>(source.cycles) * source.period, static_cast<double>(source.cycles) / std::nearbyint(frequency)}) {
      if (std::abs(seconds / (static_cast<double>(source.cycles) * source.period) - 1.0) > tolerance::ratio_rounding) continue;
      const std::size_t length = fmt::format("{}", seconds).size();
      if (length < shortest) {
        shortest = length;
        best = seconds;
      }
    }
  }
  return best;
}

/// The cycles of each source in the common period; a failure is said in words.
std::string count_cycles(std::vector<PeriodicSource>& sources) {
  const PeriodicSource first = sources.front();
  std::vector<Ratio> ratios;
  for (const PeriodicSource& source : sources) {
    const auto ratio = ratio_of(source.period / first.period);
    if (!ratio)
      return fmt::format("no common period of {} and {}: their ratio is not a fraction with a denominator up to {}; try period=",
                         frequency_text(first), frequency_text(source), largest_denominator);
    ratios.push_back(*ratio);
  }
  // The common period is first.period·lcm(p)/gcd(q).
  std::int64_t multiple = 1, divisor = 0;
  for (const Ratio& ratio : ratios) {
    const std::int64_t factor = ratio.p / std::gcd(multiple, ratio.p);
    if (factor > (std::int64_t{1} << 53) / multiple)
      return fmt::format("the common period of {} and the other sources is out of range; try period=", frequency_text(first));
    multiple *= factor;
    divisor = std::gcd(divisor, ratio.q);
  }
  auto slowest = sources.begin();
  for (std::size_t i = 0; i < sources.size(); ++i) {
    sources[i].cycles = multiple / ratios[i].p * (ratios[i].q / divisor);
    if (sources[i].cycles < slowest->cycles) slowest = sources.begin() + static_cast<std::ptrdiff_t>(i);
  }
  if (slowest->cycles <= most_slow_cycles) return {};
  const auto other = std::find_if(sources.begin(), sources.end(), [&](const PeriodicSource& s) { return s.cycles % slowest->cycles != 0; });
  return fmt::format("no common period of {} and {}: it would contain {} periods of {}; try period=", frequency_text(*slowest),
                     frequency_text(other == sources.end() ? first : *other), slowest->cycles, slowest->name);
}

}  // namespace

CommonPeriod common_period(const std::vector<model::Source>& sources) {
  CommonPeriod common;
  std::set<std::string> seen;
  for (const model::Source& source : sources) {
    const double period = std::visit(PeriodOf{}, source.function);
    if (period == 0.0 || source.stands_in || !seen.insert(source.label.name).second) continue;
    if (period > 0.0)
      common.sources.push_back({source.label.name, period, 1});
    else
      common.settled.push_back(source.label.name);
  }
  if (common.sources.empty()) return common;
  common.failure = count_cycles(common.sources);
  if (common.failure.empty()) common.seconds = seconds_of(common.sources);
  return common;
}

std::int64_t whole_multiple(double period, double part) {
  const double ratio = period / part;
  const double whole = std::nearbyint(ratio);
  return whole >= 1.0 && whole < 9e15 && std::abs(ratio - whole) <= tolerance::whole_ratio * whole ? static_cast<std::int64_t>(whole) : 0;
}

model::Network with_settled_sources(model::Network network) {
  for (model::Source& source : network.sources) source.function = std::visit(Settled{}, source.function);
  return network;
}

}  // namespace pwlsim::steady
