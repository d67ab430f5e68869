#pragma once
/// Numbers of a random deck: all near the deck's own units of time, resistance and voltage, so that a run has few periods, with now and then
/// one that is zero, negative, or out of all proportion.

#include <string>
#include <vector>

#include "support/random.hpp"

namespace pwlsim::test {

class DeckValues {
 public:
  explicit DeckValues(Random& random);

  // Values of cards, spelled in one of the ways of the language. `parameters` may be part of them: dimensionless, near one.
  std::string resistance(const std::vector<std::string>& parameters);
  std::string capacitance(const std::vector<std::string>& parameters);
  std::string inductance(const std::vector<std::string>& parameters);
  std::string voltage(const std::vector<std::string>& parameters);
  std::string current(const std::vector<std::string>& parameters);
  std::string gain(const std::vector<std::string>& parameters);

  /// `low` to `high` units of time, as a plain number.
  std::string time(double low, double high);
  /// So many a unit of time.
  std::string frequency(double low, double high);
  /// A number near one.
  std::string factor();
  std::string volts();
  std::string amperes();

  /// Three digits, with a suffix or without.
  std::string number(double value);

 private:
  double spread(double unit, double low_decade, double high_decade);
  std::string value(double value, const std::vector<std::string>& parameters, const std::vector<double>& extremes);

  Random& random_;
  double time_, resistance_, voltage_;
};

}  // namespace pwlsim::test
