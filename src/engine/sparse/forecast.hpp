#pragma once
/// Where switches change at a known instant: the diodes that take over a current then, or lose theirs.
///
/// One implicit Euler step from the point, in the position with the switches as they are now, and its diodes on the wrong side changed until none is left. Columns of the factor that was used last stand
/// for factors of these positions (Sherman, Morrison and Woodbury), so that all of it costs a few solutions. What it finds is to be tried first, and proves itself like any other position.

#include <vector>

#include "engine/sparse/factors.hpp"
#include "engine/sparse/sources.hpp"

namespace pwlsim::engine::sparse {

class Forecast {
 public:
  Forecast(const Descriptor& descriptor, Factors& factors, const Sources& sources)
      : descriptor_(descriptor), factors_(factors), sources_(sources) {}

  /// A voltage that is not small, volts.
  void note_voltage(double least) { least_ = least; }
  /// Diodes of `on` to the sides that follow from z at `time`. False: they may stay, or that cannot be told.
  [[nodiscard]] bool find(double time, const std::vector<double>& z, Position& on);

 private:
  [[nodiscard]] std::vector<std::size_t> wrong(const Position& on);

  const Descriptor& descriptor_;
  Factors& factors_;
  const Sources& sources_;
  double least_ = 0.0;
  std::vector<double> right_, z_, w_;
};

}  // namespace pwlsim::engine::sparse
