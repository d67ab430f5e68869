#pragma once
/// A run with what derivatives of its measurements read of it: the values, the pieces below integrals, all places of extremes.

#include <map>
#include <memory>
#include <vector>

#include "analysis/extreme_finder.hpp"
#include "analysis/transient.hpp"
#include "circuit/measurement.hpp"
#include "measure/expression_gradient.hpp"
#include "measure/measuring.hpp"

namespace pwlsim::analysis {

/// A piece of the run, kept.
struct KeptPiece {
  double from = 0.0, to = 0.0, begin = 0.0, length = 0.0;
  std::vector<double> values;
};

/// What measured the run, and where.
struct MeasuredPass {
  const circuit::Measurements* measurements = nullptr;
  double start = 0.0, stop = 0.0;
  measure::Record record;
  std::vector<KeptPiece> pieces;                  ///< over all windows of integrals
  std::map<std::size_t, ExtremePlaces> extremes;  ///< by measurement
};

/// What of the run's pieces derivatives read.
class PieceKeeper;
class PieceLook {
 public:
  /// `run`, whose record is known, takes pieces and extremes.
  explicit PieceLook(MeasuredPass& run);
  PieceLook(const PieceLook&) = delete;
  PieceLook& operator=(const PieceLook&) = delete;
  ~PieceLook();
  [[nodiscard]] bool is_needed() const { return to_ > from_; }
  /// Of a run over the whole; without a sink where nothing is needed.
  [[nodiscard]] engine::Probes probes() const;
  void finish();

 private:
  MeasuredPass& run_;
  double from_ = 0.0, to_ = 0.0;
  std::unique_ptr<PieceKeeper> keeper_;
};

/// What a run has measured, without its pieces.
[[nodiscard]] MeasuredPass pass_of(const circuit::Measurements& measurements, const measure::Record& record, double start, double stop);
/// Measures: `simulate` runs over the whole. `known`: what has been measured already, or null.
[[nodiscard]] MeasuredPass measure_run(const circuit::Measurements& measurements, const Simulate& simulate, engine::Request request,
                                       double start, double stop, double longest_window, const measure::Record* known);

/// What the expression takes of each of its probes, where that is the same at all times and nothing but signals moves it; else empty.
[[nodiscard]] std::vector<double> even_weights(const circuit::MeasuredExpression& expression, const std::vector<double>& results);
/// The gradient to the probes at these values, where nothing but signals moves the expression; else empty.
[[nodiscard]] std::vector<double> gradient_by_signals(const measure::ExpressionGradient& gradient, const std::vector<double>& signals,
                                                      const std::vector<double>& results);
[[nodiscard]] bool reads_time(const circuit::MeasuredExpression& expression);
/// Values of which no sum or product is another one's, nor zero.
[[nodiscard]] std::vector<double> some_values(std::size_t count);

}  // namespace pwlsim::analysis
