#pragma once
/// What diodes carry over a run: where to take the tangents of exponential ones.

#include <array>
#include <vector>

#include "engine/run.hpp"

namespace pwlsim::measure {

/// Charge by the current at which it was carried, in bins of equal width in the logarithm.
class ChargeSpectrum {
 public:
  struct Bin {
    double charge = 0.0;   ///< A s
    double current = 0.0;  ///< A, the mean within the bin weighted by charge
  };

  void add(double current, double charge);
  /// Those that hold more than a ten-thousandth of all charge, ascending.
  [[nodiscard]] std::vector<Bin> bins() const;

 private:
  static constexpr std::size_t per_decade = 12, decades = 16;
  static constexpr double least = 1e-10;  ///< A
  struct Sum {
    double charge = 0.0, square = 0.0;
  };
  std::array<Sum, per_decade * decades> sums_{};
};

/// Probes come in pairs, a diode's current and the voltage across it.
class DiodeCurrents : public engine::PieceSink {
 public:
  explicit DiodeCurrents(std::size_t diodes) : diodes_(diodes) {}

  void before_start(std::span<const double>) override {}
  void take(const engine::Piece& piece) override;

  /// The mean of a diode's current, weighted by the charge it carries: ∫i² dt / ∫i dt, A. Zero where it carries none.
  [[nodiscard]] double mean(std::size_t diode) const;
  [[nodiscard]] std::size_t pieces() const { return pieces_; }
  [[nodiscard]] const ChargeSpectrum& spectrum(std::size_t diode) const { return diodes_[diode].spectrum; }
  /// The highest and the lowest voltage across it, V; 0 where it has the other sign.
  [[nodiscard]] double highest_voltage(std::size_t diode) const { return diodes_[diode].highest; }
  [[nodiscard]] double lowest_voltage(std::size_t diode) const { return diodes_[diode].lowest; }

 private:
  struct Sums {
    double charge = 0.0, square = 0.0, highest = 0.0, lowest = 0.0;
    ChargeSpectrum spectrum;
  };
  std::vector<Sums> diodes_;
  std::size_t pieces_ = 0;
};

}  // namespace pwlsim::measure
