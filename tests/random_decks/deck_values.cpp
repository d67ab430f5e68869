#include "random_decks/deck_values.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

namespace pwlsim::test {
namespace {

constexpr double strange = 0.015;  ///< of all values of elements

const std::vector<double> extreme_resistances{0.0, -1.0, 1e-9, 1e9, -1e-3, 1e-15, 1e15, 1e300};
// Smaller ones ring faster than any run has patience for.
const std::vector<double> extreme_stores{0.0, -1.0, 1e-4, 1e9, 1e15, 1e300};
const std::vector<double> extreme_levels{0.0, 1e6, -1e6, 1e-12, 1e18, 1e300};

}  // namespace

DeckValues::DeckValues(Random& random)
    : random_(random),
      time_(std::pow(10.0, random.whole(-8, 0))),
      resistance_(std::pow(10.0, random.whole(-1, 5))),
      voltage_(std::pow(10.0, random.whole(-1, 3))) {}

double DeckValues::spread(double unit, double low_decade, double high_decade) {
  return unit * std::pow(10.0, random_.between(low_decade, high_decade));
}

std::string DeckValues::number(double value) {
  struct Suffix {
    const char* text;
    double factor;
  };
  static constexpr std::array<Suffix, 9> suffixes{
      {{"T", 1e12}, {"g", 1e9}, {"Meg", 1e6}, {"k", 1e3}, {"m", 1e-3}, {"u", 1e-6}, {"n", 1e-9}, {"p", 1e-12}, {"", 1.0}}};
  if (random_.chance(0.5)) return fmt::format("{:.3g}", value);
  for (const Suffix& suffix : suffixes) {
    const double scaled = std::abs(value) / suffix.factor;
    if (scaled >= 1.0 && scaled < 1000.0) return fmt::format("{:.3g}{}", value / suffix.factor, suffix.text);
  }
  return fmt::format("{:.3g}", value);
}

std::string DeckValues::value(double value, const std::vector<std::string>& parameters, const std::vector<double>& extremes) {
  if (random_.chance(strange)) value *= random_.one_of(extremes);
  if (random_.chance(0.002)) return random_.one_of(std::array{"inf", "{1/0}", "1e-300", "1e400", "-0", "{sqrt(-1)}", "{0*inf}", "1e-320"});
  if (!parameters.empty() && random_.chance(0.2)) {
    const char* form =
        random_.one_of(std::array{"{{{0}*{1}}}", "'{0}*{1}'", "{{{0}/{1}}}", "{{{1}>0.5?{0}:2*{0}}}", "{{max({0},{0}*{1})}}"});
    return fmt::format(fmt::runtime(form), fmt::format("{:.3g}", value), random_.one_of(parameters));
  }
  return number(value);
}

std::string DeckValues::resistance(const std::vector<std::string>& parameters) {
  return value(spread(resistance_, -1.5, 1.5), parameters, extreme_resistances);
}
std::string DeckValues::capacitance(const std::vector<std::string>& parameters) {
  return value(spread(time_ / resistance_, -1.5, 1.0), parameters, extreme_stores);
}
std::string DeckValues::inductance(const std::vector<std::string>& parameters) {
  return value(spread(time_ * resistance_, -1.5, 1.0), parameters, extreme_stores);
}
std::string DeckValues::voltage(const std::vector<std::string>& parameters) {
  return value(spread(voltage_, -1.0, 1.0), parameters, extreme_levels);
}
std::string DeckValues::current(const std::vector<std::string>& parameters) {
  return value(spread(voltage_ / resistance_, -1.0, 1.0), parameters, extreme_levels);
}
std::string DeckValues::gain(const std::vector<std::string>& parameters) {
  return value(random_.chance(0.3) ? -spread(1.0, -1.0, 1.0) : spread(1.0, -1.0, 1.0), parameters, extreme_levels);
}

std::string DeckValues::time(double low, double high) { return number(time_ * random_.between(low, high)); }
std::string DeckValues::frequency(double low, double high) { return number(random_.between(low, high) / time_); }
std::string DeckValues::factor() { return number(random_.between(0.2, 3.0)); }
std::string DeckValues::volts() { return number(voltage_ * random_.between(-2.0, 2.0)); }
std::string DeckValues::amperes() { return number(voltage_ / resistance_ * random_.between(-2.0, 2.0)); }

}  // namespace pwlsim::test
