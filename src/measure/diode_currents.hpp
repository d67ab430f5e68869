#pragma once
/// What diodes carry over a run: where to take the tangents of exponential ones.

#include <vector>

#include "engine/run.hpp"

namespace pwlsim::measure {

/// Probes come in pairs, a diode's current and the voltage across it.
class DiodeCurrents : public engine::PieceSink {
 public:
  explicit DiodeCurrents(std::size_t diodes) : diodes_(diodes) {}

  void before_start(std::span<const double>) override {}
  void take(const engine::Piece& piece) override;

  /// The mean of a diode's current, weighted by the charge it carries: ∫i² dt / ∫i dt, A. Zero where it carries none.
  [[nodiscard]] double mean(std::size_t diode) const;
  /// The highest voltage across it, V.
  [[nodiscard]] double highest_voltage(std::size_t diode) const { return diodes_[diode].voltage; }

 private:
  struct Sums {
    double charge = 0.0, square = 0.0, voltage = 0.0;
  };
  std::vector<Sums> diodes_;
};

}  // namespace pwlsim::measure
