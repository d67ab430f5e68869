#pragma once
/// The waveforms of a converter, independently of the program: Radau IIA of order nine between events, the position of every valve found by
/// complementarity (a step of implicit Euler, whose positions are exchanged until voltages and currents have their signs), events located by repeating
/// the step until it ends on them. In 80-bit arithmetic.

#include <string>
#include <vector>

#include "converters/equations.hpp"

namespace pwlsim::test::converters {

struct Settings {
  Real tolerance =
      2e-6L;  ///< on the highest coefficient of a step's polynomial, relative to each state; the error at the end is about its square
  Real first_step = 1e-8L;   ///< of implicit Euler after an event, relative to the shortest period
  double patience = 20.0;    ///< s of the processor
  std::vector<Real> scales;  ///< of the states, from an earlier run; empty: what has been seen so far
};

struct Waveforms {
  std::string trouble;  ///< why the run ended early
  std::vector<double> times;
  std::vector<std::vector<double>> rows;  ///< states at each time
  std::vector<Real> scales;               ///< largest of each state
  std::size_t events = 0, steps = 0;
};

[[nodiscard]] Waveforms integrate(const Converter& converter, const Settings& settings);

/// Largest difference, relative to the largest value of each signal in the run, between rows too, and where.
struct Difference {
  double size = 0.0;
  std::size_t signal = 0, row = 0;
};
[[nodiscard]] Difference largest_difference(const Waveforms& reference, const std::vector<std::vector<double>>& other,
                                            const Converter& converter);

/// Runs with finer and finer settings until the rows change by less than `target` relative to each signal.
struct Resolved {
  Waveforms waveforms;
  double error = 1.0;  ///< the last change …
  Difference where{};  ///< … and where
};
[[nodiscard]] Resolved resolve(const Converter& converter, double target, double patience);

}  // namespace pwlsim::test::converters
