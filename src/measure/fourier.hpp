#pragma once
/// Fourier coefficients over whole periods, as exact as integrals.
///
/// y(t) = a_0 + Σ A_k sin(2πk f (t − t_0) + φ_k), t_0 the begin of the window (Tstop − periods/f), as SPICE counts phases. Two distortions:
/// of the listed harmonics, √(Σ_{k≥2} A_k²)/A_1, and of all harmonics, √(2(y_rms² − a_0²) − A_1²)/A_1 (Parseval). An impulse in the window contributes
/// to every harmonic and makes the latter infinite.

#include <complex>
#include <string>
#include <vector>

#include "circuit/measurement.hpp"
#include "measure/piece_view.hpp"

namespace pwlsim::measure {

struct Harmonic {
  double frequency = 0.0;  ///< Hz
  double magnitude = 0.0;  ///< the mean for number 0
  double phase = 0.0;      ///< degrees
};

struct FourierResult {
  std::string column;
  std::string failure;  ///< "" if there are coefficients
  std::vector<Harmonic> harmonics;
  double listed_distortion = 0.0, total_distortion = 0.0;  ///< relative to the fundamental; 0.1 is ten percent
};

class FourierMeter {
 public:
  FourierMeter(const circuit::FourierAnalysis& analysis, std::size_t signal, double start, double stop);

  [[nodiscard]] double from() const { return from_; }
  [[nodiscard]] double to() const { return to_; }
  [[nodiscard]] bool is_possible() const { return failure_.empty(); }
  void take(PieceView& view);
  /// ∫ dt of each probe over an instant.
  void take_impulse(double time, std::span<const double> values);
  [[nodiscard]] FourierResult finish(double reached) const;

 private:
  void add(const linalg::LegendreValues& values, double from, double to);

  const circuit::FourierAnalysis& analysis_;
  std::size_t signal_;
  Program program_;
  std::string failure_;
  double from_ = 0.0, to_ = 0.0, periods_ = 1.0;
  std::vector<std::complex<long double>> sums_;
  long double square_ = 0.0L;
  bool has_impulse_ = false;
};

/// A table for each signal, in ngspice's format.
[[nodiscard]] std::string fourier_text(const FourierResult& result);

}  // namespace pwlsim::measure
