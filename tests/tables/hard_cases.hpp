#pragma once
/// Measured errors of the 35 hard cases.

#include <optional>
#include <string>
#include <vector>

namespace pwlsim::test {

struct HardCase {
  int number = 0;
  std::string system;  ///< in a few words
  std::string tests;   ///< where it is tested
};

/// What a run of a case was off by.
struct Measured {
  std::string problem;               ///< empty, or why there is nothing to measure: then the case fails
  std::string outcome;               ///< where the right answer is a refusal, or a count
  std::optional<double> value;       ///< worst error of a signal, relative to its largest value
  std::optional<double> event_time;  ///< worst error of an event's time, relative to the run's length
  bool touch = false;                ///< a double root: half the digits are all that double precision holds
};

[[nodiscard]] const std::vector<HardCase>& hard_cases();

/// Runs all decks of a case, and takes the worst.
[[nodiscard]] Measured measure(const HardCase& hard_case);

}  // namespace pwlsim::test
