#pragma once
/// Response of an orbit to inputs ε·Re a_k e^{jωt}: δy(t) = ε·Re Σ_m c_m e^{j(ω + mω_s)t}, exact at every frequency.
///
/// With r = e^{−jωt}δξ a segment is r′ = (A − jω) r + B̂, an instant r⁺ = P r⁻ + P_w ŵ + (P f⁻ − f⁺) δt̂, and a period ends where it began. An output that
/// jumps by y⁻ − y⁺ at an instant that moves adds (y⁻ − y⁺)·δt̂. Floquet theory of piecewise linear systems; Middlebrook & Ćuk 1976 is its average.

#include <complex>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "steady/flow_series.hpp"
#include "steady/linearised.hpp"

namespace pwlsim::steady {

using Complex = std::complex<double>;
using ComplexVector = Eigen::VectorXcd;
using ComplexMatrix = Eigen::MatrixXcd;

/// A waveform that is shifted in time: shifts of the instants at which it or its slope jumps, and an input between them.
struct TimeShifts {
  std::vector<Complex> shifts;  ///< δt̂ of each instant of the orbit, s, besides those by state and inputs; empty: none
  /// Amplitude of an input at a time of the period that is not a corner; empty: that of `amplitudes`.
  std::function<Complex(std::size_t input, double time)> amplitude{};
};

class Transfer {
 public:
  /// `signals`: number of signals of the model.
  Transfer(const LinearisedOrbit& orbit, std::size_t signals);

  struct Response {
    ComplexVector signals;     ///< c_m of each; not finite where the response is infinite
    bool is_singular = false;  ///< e^{jωT} is a multiplier, and the input excites its direction
  };
  /// c_`harmonic` at `frequency`, Hz, for inputs of these amplitudes, or of a waveform that is moved. With `sample`, s, the sampled response: e^{−jωt}δy at
  /// that time of the period instead.
  [[nodiscard]] Response at(double frequency, int harmonic, const std::vector<Complex>& amplitudes, const TimeShifts& shifts = {},
                            std::optional<double> sample = std::nullopt);

 private:
  struct Pass;
  struct Travelled {
    ComplexVector end, integral;
  };
  Travelled travel(const LinearSegment& s, double length, const ComplexVector& c0, const ComplexVector& b, Pass& pass);
  static Travelled travel_by_exponential(const LinearSegment& s, double length, const ComplexVector& c0, const ComplexVector& b,
                                         const Pass& pass);
  void run(Pass& pass);
  void segment(const LinearSegment& s, Pass& pass);
  /// The start of the deviation where e^{jωT} is a multiplier; none if the input excites its direction. `pass` has run from zero.
  [[nodiscard]] std::optional<ComplexVector> start_in_resonance(const Pass& pass, const ComplexMatrix& closing);
  [[nodiscard]] Complex guard_shift(const LinearGuard& guard, const Pass& pass) const;
  void instant(const LinearInstant& at, const Complex& shift, Pass& pass);
  const Matrix& propagator(const model::Mode& mode, double length);
  /// Of a stretch that is brief for the frequencies: what an input adds to its end, what its begin and an input add to the integral.
  struct Slow {
    ComplexMatrix whole, whole_out, rest;
  };
  const Slow& slow_of(const model::Mode& mode, double length, Pass& pass);

  const LinearisedOrbit& orbit_;
  std::size_t signals_;
  Matrix monodromy_;
  std::map<std::pair<const model::Mode*, double>, Matrix> propagators_;
  std::map<std::pair<const model::Mode*, double>, FlowSeries> series_;
};

}  // namespace pwlsim::steady
