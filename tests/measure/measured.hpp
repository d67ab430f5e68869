#pragma once
/// A deck measured in process.

#include <atomic>
#include <catch2/catch.hpp>
#include <map>
#include <string>

#include "measure/measuring.hpp"

namespace pwlsim::test {

struct Measured {
  std::string messages;  ///< rendered errors of the deck
  measure::Results results;
  int passes = 0;
  std::map<std::string, double> value;  ///< of those that did not fail

  [[nodiscard]] const measure::Result& result(const std::string& name) const;
};

/// Of the value at hand.
constexpr double exact = 1e-12;

[[nodiscard]] inline Approx near(double value, double tolerance = exact) { return Approx(value).epsilon(tolerance).margin(0.0); }

/// On the exact engine, or with `reltol` > 0 on the sparse one.
[[nodiscard]] Measured measure_deck(const std::string& text, double reltol = 0.0, const std::atomic<int>* interrupt = nullptr);

}  // namespace pwlsim::test
