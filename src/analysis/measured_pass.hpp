#pragma once
/// A run with the data for derivatives of its measurements: the values, the pieces of integrals, all places of extremes.

#include <map>
#include <memory>
#include <vector>

#include "analysis/extreme_finder.hpp"
#include "analysis/transient.hpp"
#include "circuit/measurement.hpp"
#include "measure/expression_gradient.hpp"
#include "measure/measuring.hpp"

namespace pwlsim::analysis {

/// A kept piece of the run.
struct KeptPiece {
  double from = 0.0, to = 0.0, begin = 0.0, length = 0.0;
  std::vector<double> values;
};

/// The measurements of the run and their times.
struct MeasuredPass {
  const circuit::Measurements* measurements = nullptr;
  double start = 0.0, stop = 0.0;
  bool is_whole = true;  ///< the run for its pieces completed
  measure::Record record;
  std::vector<KeptPiece> pieces;                  ///< over all windows of integrals
  std::map<std::size_t, ExtremePlaces> extremes;  ///< by measurement
};

/// Keeps the pieces that derivatives read.
class PieceKeeper;
class PieceLook {
 public:
  /// `run`, whose record is known, takes pieces and extremes.
  explicit PieceLook(MeasuredPass& run);
  PieceLook(const PieceLook&) = delete;
  PieceLook& operator=(const PieceLook&) = delete;
  ~PieceLook();
  [[nodiscard]] bool is_needed() const { return to_ > from_; }
  /// For a run over the whole time; without a sink if nothing is needed.
  [[nodiscard]] engine::Probes probes() const;
  void finish();

 private:
  MeasuredPass& run_;
  double from_ = 0.0, to_ = 0.0;
  std::unique_ptr<PieceKeeper> keeper_;
};

/// The measurements of a run, without its pieces.
[[nodiscard]] MeasuredPass pass_of(const circuit::Measurements& measurements, const measure::Record& record, double start, double stop);
/// Measures: `simulate` runs over the whole time. `known`: existing measurements, or null.
[[nodiscard]] MeasuredPass measure_run(const circuit::Measurements& measurements, const Simulate& simulate, engine::Request request,
                                       double start, double stop, double longest_window, const measure::Record* known);

/// The weight of each probe in the expression, if constant in time and if only signals change the expression; else empty.
[[nodiscard]] std::vector<double> even_weights(const circuit::MeasuredExpression& expression, const std::vector<double>& results);
/// The gradient to the probes at these values, if only signals change the expression; else empty.
[[nodiscard]] std::vector<double> gradient_by_signals(const measure::ExpressionGradient& gradient, const std::vector<double>& signals,
                                                      const std::vector<double>& results);
[[nodiscard]] bool reads_time(const circuit::MeasuredExpression& expression);
/// Values without coinciding sums or products, and without zeros.
[[nodiscard]] std::vector<double> some_values(std::size_t count);

}  // namespace pwlsim::analysis
