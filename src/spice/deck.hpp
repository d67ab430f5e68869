#pragma once
/// A circuit as a deck for stock ngspice in batch mode: every element its smoothed twin, numbers expanded, no dialect needed.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostic.hpp"
#include "circuit/circuit.hpp"

namespace pwlsim::spice {

inline constexpr double default_sharpness = 1e-3;
inline constexpr double least_sharpness = 1e-9, largest_sharpness = 1.0;

/// A small R–C across each diode and switch. Without it nothing limits the voltage of an inductor whose current a contact of 1e8 ohm interrupts, and
/// ngspice ends with "Timestep too small". With a circuit of impedance Z whose events are T apart, C = X·T/Z and R = Z/√X: its effect vanishes with X like
/// that of the smoothing, and for every X it damps the ringing between C and an inductance of about Z·T.
struct Snubber {
  double impedance = 0.0;  ///< Z, ohm; 0: no snubber
  double time = 0.0;       ///< T, s
};

/// The absolute tolerances of the deck (abstol, vntol): ngspice does not resolve smaller values.
inline constexpr double current_tolerance = 1e-9, voltage_tolerance = 1e-6;

struct DeckSettings {
  double sharpness = default_sharpness;  ///< elements/twin.hpp
  double reltol = 1e-4;
  double largest_step = 0.0;  ///< s; 0: Tstep, or a thousandth of the run if that is smaller
  bool gear = false;          ///< instead of the trapezoidal rule
  Snubber snubber;
  bool switching = false;            ///< also save the controls of diodes and switches
  std::vector<double> sample_times;  ///< s, ascending, above 0: ngspice is made to step on them
};

/// A signal as a sum of vectors that ngspice saves: Σ sign·vector.
struct SignalVectors {
  std::string name;  ///< as in the CSV header
  std::vector<std::pair<std::string, double>> terms;
};

/// A diode or a switch: on from when `control` passes on_level until it falls below off_level.
struct SwitchingPart {
  SignalVectors control;  ///< named after the element
  double on_level = 0.0, off_level = 0.0;
};

struct SmoothDeck {
  std::string text;
  std::vector<SignalVectors> signals;    ///< in the order of the columns
  std::vector<SwitchingPart> switching;  ///< if settings.switching requests them
};

/// `circuit` must have passed circuit::assemble. An element without an equivalent in ngspice is an error E-no-twin; then the result is empty.
[[nodiscard]] std::optional<SmoothDeck> smooth_deck(const circuit::FlatCircuit& circuit, const DeckSettings& settings,
                                                    Diagnostics& diagnostics);

}  // namespace pwlsim::spice
