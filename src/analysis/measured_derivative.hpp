#pragma once
/// Derivatives of measured values as functionals of the derivatives of signals: once for all parameters.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "analysis/measured_functional.hpp"
#include "linalg/legendre.hpp"

namespace pwlsim::analysis {

class MeasuredFunctionals {
 public:
  MeasuredFunctionals(const MeasuredPass& run, const steady::Sensitivity& sensitivity);

  /// Valid as long as this object.
  [[nodiscard]] const MeasuredFunctional& of(std::size_t measurement);

 private:
  using Kind = circuit::Measurement::Kind;
  using Side = steady::Side;
  /// An expression at one time: its value and rate, and the weights of its derivative at that fixed time.
  struct Jet {
    double value = 0.0, rate = 0.0;
    MeasuredFunctional moved;
    MeasuredSum moved_rate;
  };

  [[nodiscard]] MeasuredFunctional compute(std::size_t measurement);
  [[nodiscard]] MeasuredFunctional of_constant(const circuit::MeasuredExpression& expression);
  void add_results(double weight, const measure::GradientValue& gradient, MeasuredFunctional& sum);
  struct Shares {
    double from = 0.0, to = 0.0;
    std::array<linalg::LegendreValues, linalg::legendre_points> points{};
  };
  [[nodiscard]] const Shares& shares_on(double from, double to, double rounding);
  void add_numbers(double weight, const measure::GradientValue& at);
  [[nodiscard]] Jet jet_of(const circuit::MeasuredExpression& expression, double time, Side side);
  [[nodiscard]] std::optional<std::size_t> instant_at(double time) const;
  [[nodiscard]] MeasuredFunctional of_window(std::size_t measurement);
  void add_integral(const circuit::Measurement& measurement, const measure::Place& place, bool squares, double scale,
                    MeasuredFunctional& sum);
  /// The gradient of a polynomial of second degree in the signals, for every point of a run: g + H·s.
  struct AffineGradient {
    std::vector<double> constant, slopes;  ///< slopes: row by row; both empty: not such a polynomial

    void at(const std::vector<double>& signals, std::vector<double>& gradient) const;
  };
  [[nodiscard]] AffineGradient affine_gradient(const circuit::MeasuredExpression& expression, bool squares) const;
  void take_values(const KeptPiece& piece, const std::vector<int>& probes, const Shares* shares);
  void weigh(const measure::ExpressionGradient& gradient, const AffineGradient& affine, double from, double to, bool squares, double scale);
  void add_inside(const measure::ExpressionGradient& gradient, const AffineGradient& affine, std::size_t piece, double from, double to,
                  bool squares, double scale, MeasuredFunctional& sum);
  [[nodiscard]] bool add_stretch(const circuit::Measurement& measurement, const measure::Place& place, double scale,
                                 MeasuredFunctional& sum);
  void add_instants(const circuit::Measurement& measurement, const measure::Place& place, bool squares, double scale,
                    MeasuredFunctional& sum);
  void add_extreme(double weight, std::size_t measurement, bool is_largest, MeasuredFunctional& sum);
  [[nodiscard]] MeasuredFunctional of_extreme(const circuit::Measurement& measurement, double time, bool is_largest,
                                              const measure::Place& place);
  [[nodiscard]] MeasuredFunctional of_extreme_inside(const circuit::Measurement& measurement, double time, bool is_largest);
  [[nodiscard]] MeasuredFunctional of_extreme_at_end(const circuit::Measurement& measurement, double time, bool is_largest, bool at_begin);
  [[nodiscard]] MeasuredFunctional of_wrap(const circuit::Measurement& measurement, bool is_largest);
  [[nodiscard]] MeasuredFunctional of_extreme_time(std::size_t measurement, bool is_largest);
  [[nodiscard]] std::string event_at(std::size_t instant) const;
  [[nodiscard]] MeasuredFunctional of_place(std::size_t measurement);
  [[nodiscard]] MeasuredFunctional crossing_moves(const circuit::Crossing& crossing, double time);
  [[nodiscard]] MeasuredFunctional from_moves(const circuit::Measurement& measurement);
  [[nodiscard]] MeasuredFunctional to_moves(const circuit::Measurement& measurement);

  const MeasuredPass& run_;
  const steady::Sensitivity& sensitivity_;
  std::vector<std::optional<MeasuredFunctional>> known_;
  std::vector<int> signals_;  ///< of all probes
  std::array<Shares, 8> shares_;
  std::size_t next_shares_ = 0;
  std::vector<linalg::LegendreValues> values_, weights_;  ///< of each probe of an expression, at the points of a part
  measure::GradientValue read_;                           ///< of an integral: results and numbers, added up
};

}  // namespace pwlsim::analysis
