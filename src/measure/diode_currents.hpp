#pragma once
/// The currents of diodes over a run, at which the tangents of exponential ones are taken.

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
  /// Adds all charges of another one times `factor`.
  void add(const ChargeSpectrum& other, double factor);
  /// Bins with more than a ten-thousandth of all charge, ascending.
  [[nodiscard]] std::vector<Bin> bins() const;

 private:
  static constexpr std::size_t per_decade = 12, decades = 16;
  static constexpr double least = 1e-10;  ///< A
  struct Sum {
    double charge = 0.0, square = 0.0;
  };
  std::array<Sum, per_decade * decades> sums_{};
};

/// Probes come in pairs, a diode's current and the voltage across it. The run up to `stop` is divided into sixteen windows of equal length, each of which
/// counts equally for a diode that conducts in it: an inrush must not decide, although it may carry most of a rectifier's charge.
class DiodeCurrents : public engine::PieceSink {
 public:
  DiodeCurrents(std::size_t diodes, double stop) : stop_(stop), diodes_(diodes) {}

  void before_start(std::span<const double>) override {}
  void take(const engine::Piece& piece) override;

  /// The mean of a diode's current over the windows, in each weighted by charge: ∫i² dt / ∫i dt, A. Zero if it carries no charge.
  [[nodiscard]] double mean(std::size_t diode) const;
  /// All that it carries, A s.
  [[nodiscard]] double charge(std::size_t diode) const;
  [[nodiscard]] std::size_t pieces() const { return pieces_; }
  /// The charge of each window is 1.
  [[nodiscard]] ChargeSpectrum spectrum(std::size_t diode) const;
  /// The highest and the lowest voltage across it, V; 0 if it has the other sign.
  [[nodiscard]] double highest_voltage(std::size_t diode) const { return diodes_[diode].highest; }
  [[nodiscard]] double lowest_voltage(std::size_t diode) const { return diodes_[diode].lowest; }

 private:
  static constexpr std::size_t windows = 16;
  struct Window {
    double charge = 0.0, square = 0.0;
    ChargeSpectrum spectrum;
  };
  struct Sums {
    double highest = 0.0, lowest = 0.0;
    std::vector<Window> windows{DiodeCurrents::windows};
  };
  /// The windows in which the diode conducts.
  [[nodiscard]] std::vector<const Window*> counted(std::size_t diode) const;

  double stop_;
  std::vector<Sums> diodes_;
  std::size_t pieces_ = 0;
};

}  // namespace pwlsim::measure
