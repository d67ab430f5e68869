#pragma once
/// Periods of sources, their smallest common period, and sources that have always been periodic.

#include <cstdint>
#include <string>
#include <vector>

#include "model/network.hpp"

namespace pwlsim::steady {

/// A fraction p/q that a ratio of two decimals is, to its rounding.
struct Ratio {
  std::int64_t p = 0, q = 1;
};

/// Largest denominator of a ratio of periods, and most periods of the slowest source in a common period.
inline constexpr std::int64_t largest_denominator = 1'000'000, most_slow_cycles = 1000;

struct PeriodicSource {
  std::string name;
  double period = 0.0;      ///< s
  std::int64_t cycles = 1;  ///< in the common period
};

struct CommonPeriod {
  double seconds = 0.0;                 ///< 0: no source is periodic, or there is no common period
  std::vector<PeriodicSource> sources;  ///< that are periodic
  std::vector<std::string> settled;     ///< sources that vary but do not repeat: their last value is used
  std::string failure;                  ///< why there is no common period; "" if there is one, or no source is periodic
};

/// Of the sources; those of one name count once.
[[nodiscard]] CommonPeriod common_period(const std::vector<model::Source>& sources);

/// The ratio of `period` to `part`, if that is a whole number; else 0.
[[nodiscard]] std::int64_t whole_multiple(double period, double part);

/// The network with sources that have always been periodic, t = 0 being what a multiple of every period after their delay is to the sources as written; those
/// that do not repeat keep their last value.
[[nodiscard]] model::Network with_settled_sources(model::Network network);

}  // namespace pwlsim::steady
