#pragma once
/// An exponential diode and its tangents:  v = series·i + slope·ln(i/saturation).

namespace pwlsim::model {

struct Tangent {
  double resistance = 0.0;  ///< ohm
  double drop = 0.0;        ///< V
};

struct ExponentialLaw {
  double saturation = 0.0;  ///< A
  double slope = 0.0;       ///< V: emission coefficient times kT/q
  double series = 0.0;      ///< ohm
  double parallel = 1.0;    ///< number of such diodes in parallel

  /// Of all of them, where each carries `current`.
  [[nodiscard]] Tangent tangent(double current) const;
  /// Of one of them at a voltage, without its series resistance.
  [[nodiscard]] double current(double voltage) const;
};

}  // namespace pwlsim::model
