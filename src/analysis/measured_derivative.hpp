#pragma once
/// Derivatives of measured values, from those of the signals that they read.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/transient.hpp"
#include "circuit/measurement.hpp"
#include "measure/expression_gradient.hpp"
#include "measure/measuring.hpp"
#include "steady/sensitivity.hpp"

namespace pwlsim::analysis {

/// A derivative that is another one on the other side of a kink.
struct TwoSided {
  double left = 0.0, right = 0.0;
  std::string kink;     ///< why they differ
  std::string failure;  ///< why there is none
  [[nodiscard]] static TwoSided of(double value) { return {value, value, "", ""}; }
  [[nodiscard]] static TwoSided failed(std::string why) { return {0.0, 0.0, "", std::move(why)}; }
};

/// A piece of the run, kept.
struct KeptPiece {
  double from = 0.0, to = 0.0, begin = 0.0, length = 0.0;
  std::vector<double> values;
};

/// What measured the run, and where.
struct MeasuredPass {
  const circuit::Measurements* measurements = nullptr;
  double start = 0.0, stop = 0.0;
  std::vector<double> values;  ///< of every measurement
  std::vector<std::string> failures;
  std::vector<measure::Place> places;
  std::vector<char> has_impulse;
  std::vector<KeptPiece> pieces;  ///< over all windows of integrals
};

/// Measures: `simulate` runs over the whole.
[[nodiscard]] MeasuredPass measure_run(const circuit::Measurements& measurements, const Simulate& simulate, engine::Request request,
                                       double start, double stop, double longest_window);

/// Of one parameter.
class MeasuredDerivatives {
 public:
  /// `number`: of the parameter in gradients, −1: none. `start_moves`, `stop_moves`: derivatives of the run's begin and end, s.
  MeasuredDerivatives(const MeasuredPass& run, const steady::Sensitivity& sensitivity, const steady::Followed& followed,
                      std::size_t parameter, int number, double start_moves, double stop_moves);

  [[nodiscard]] TwoSided of(std::size_t measurement);

 private:
  using Kind = circuit::Measurement::Kind;
  using Side = steady::Side;
  /// An expression at one time: its value, and its derivatives to time and, at a fixed time, to the parameter.
  struct Jet {
    double value = 0.0, rate = 0.0, moved = 0.0, moved_rate = 0.0;
    bool has_kink = false;
  };

  [[nodiscard]] static TwoSided two_sided(double left, double right, std::string kink);
  TwoSided compute(std::size_t measurement);
  [[nodiscard]] double of_constant(const circuit::MeasuredExpression& expression);
  [[nodiscard]] double of_results(const measure::GradientValue& gradient);
  [[nodiscard]] Jet jet_of(const circuit::MeasuredExpression& expression, double time, Side side);
  [[nodiscard]] std::optional<std::size_t> instant_at(double time) const;
  [[nodiscard]] TwoSided of_window(std::size_t measurement);
  [[nodiscard]] double integral(const circuit::Measurement& measurement, const measure::Place& place, bool squares);
  [[nodiscard]] double inside(const measure::ExpressionGradient& gradient, const KeptPiece& piece, std::size_t number, double from,
                              double to, bool squares);
  [[nodiscard]] double at_instants(const circuit::Measurement& measurement, const measure::Place& place, bool squares, int side);
  [[nodiscard]] double of_extreme(const circuit::Measurement& measurement, double time, bool is_largest, const measure::Place& place);
  [[nodiscard]] TwoSided of_extreme_time(const circuit::Measurement& measurement, double time, const measure::Place& place);
  [[nodiscard]] TwoSided of_place(std::size_t measurement);
  [[nodiscard]] double crossing_moves(const circuit::Crossing& crossing, double time);
  [[nodiscard]] double from_moves(const circuit::Measurement& measurement);
  [[nodiscard]] double to_moves(const circuit::Measurement& measurement);
  void fail(std::string why) {
    if (failure_.empty()) failure_ = std::move(why);
  }
  [[nodiscard]] const std::vector<std::vector<double>>& moved_points(std::size_t piece);

  const MeasuredPass& run_;
  const steady::Sensitivity& sensitivity_;
  const steady::Followed& followed_;
  std::size_t parameter_;
  int number_;
  double start_moves_, stop_moves_;
  std::vector<std::optional<TwoSided>> known_;
  std::vector<double> results_;                                     ///< derivatives so far
  std::string failure_;                                             ///< of the measurement at hand
  std::vector<int> signals_;                                        ///< of all probes
  std::map<std::size_t, std::vector<std::vector<double>>> points_;  ///< of a piece: derivatives of the probes at its points
};

}  // namespace pwlsim::analysis
