#pragma once
/// The timing of sources as the input of `.ac`: edges of pulses, the phase of sinusoids.

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "circuit/analyses.hpp"
#include "model/source_function.hpp"
#include "steady/transfer.hpp"
#include "steady/wave.hpp"

namespace pwlsim::analysis {

/// Why the timing of a source cannot be modulated; "" where it can.
[[nodiscard]] std::string immovable(const model::SourceFunction& function, const circuit::SmallSignalAnalysis& card);
/// Whether the input moves edges of sources.
[[nodiscard]] inline bool moves_edges(const circuit::SmallSignalAnalysis& card) {
  return card.input == circuit::SmallSignalAnalysis::Input::frequency || card.input == circuit::SmallSignalAnalysis::Input::duty;
}

/// A sinusoid whose frequency is modulated. Its phase follows by 2π/(jω) per hertz, so that it adds A cos(ω₀t + φ)·2π/(jω)·e^{jωt}: two inputs, at ω ± ω₀.
struct ModulatedSine {
  std::size_t input = 0;
  double amplitude = 0.0, frequency = 0.0, phase = 0.0;  ///< from t = 0 on
  int cycles = 0;                                        ///< in the period of the orbit
};

class Modulation {
 public:
  /// `sources`: those of the card, in their order; `orbit` has an input for each. It must outlive this.
  Modulation(const circuit::SmallSignalAnalysis& card, const std::vector<const model::SourceFunction*>& sources,
             const steady::LinearisedOrbit& orbit);

  /// The card's harmonic of the response at f, to the modulation and to the inputs' `amplitudes`.
  [[nodiscard]] steady::ComplexVector response(steady::Transfer& transfer, double f, const std::vector<std::complex<double>>& amplitudes,
                                               const std::optional<double>& sample) const;

 private:
  [[nodiscard]] steady::TimeShifts shifts(const std::vector<std::complex<double>>& by) const;
  [[nodiscard]] steady::ComplexVector response_to(const ModulatedSine& sine, steady::Transfer& transfer, double f,
                                                  const std::optional<double>& sample) const;

  const circuit::SmallSignalAnalysis& card_;
  const steady::LinearisedOrbit& orbit_;
  std::vector<steady::Wave> waves_;
  std::vector<ModulatedSine> sines_;
};

}  // namespace pwlsim::analysis
