#pragma once
/// Evaluates expressions of signals on any part of a piece of the run.

#include <functional>
#include <span>
#include <vector>

#include "engine/run.hpp"
#include "linalg/legendre.hpp"
#include "measure/program.hpp"

namespace pwlsim::measure {

/// An expression on [from, to], where it is a polynomial of x = −1 … 1.
struct PolynomialPart {
  double from = 0.0, to = 0.0;  ///< s
  linalg::LegendreValues values{};
  linalg::LegendreSeries series;

  [[nodiscard]] double length() const { return to - from; }
  [[nodiscard]] double time(double x) const { return from + 0.5 * (x + 1.0) * (to - from); }
};

class PieceView {
 public:
  explicit PieceView(std::size_t probes);
  /// The piece for the next calls; its values must stay where they are.
  void set(const engine::Piece& piece);
  [[nodiscard]] const engine::Piece& piece() const { return piece_; }

  /// Values at the sixteen points of [from, to] within the piece.
  void values(const Program& program, const std::vector<double>& results, double from, double to, double* out);
  [[nodiscard]] double value(const Program& program, const std::vector<double>& results, double time);
  /// Of each probe that the expression reads.
  [[nodiscard]] std::vector<double> signals(const Program& program, double time) const;
  /// Bounds of the error of an expression from the noise of its signals, at the points of [from, to].
  [[nodiscard]] double noise_of(const Program& program, const std::vector<double>& results, double from, double to);

  /// Passes parts of [from, to] to `take`, in order, on each of which the expression is a polynomial to `resolution` of `scale`. An expression that is not a
  /// polynomial of its signals is subdivided until it is one, towards a corner or a jump as far as possible. False: it varies too fast, and the parts that
  /// were passed are not valid.
  bool resolve(const Program& program, const std::vector<double>& results, double from, double to, double scale,
               const std::function<void(const PolynomialPart&)>& take);

 private:
  [[nodiscard]] PolynomialPart part_on(const Program& program, const std::vector<double>& results, double from, double to);
  void split(const Program& program, const std::vector<double>& results, const PolynomialPart& whole, double& scale);
  [[nodiscard]] double error_of(const Program& program, const std::vector<double>& results, const PolynomialPart& part, double tail_before,
                                double scale);
  [[nodiscard]] double hidden_error(const Program& program, const std::vector<double>& results, const PolynomialPart& part);
  const double* signal_on(int probe, double from, double to);

  engine::Piece piece_;
  Inputs inputs_;
  linalg::LegendreValues times_{};
  struct Signal {
    bool has_series = false;
    linalg::LegendreSeries series;
    linalg::LegendreValues values{};
  };
  std::vector<Signal> signals_;
  std::vector<double> turns_;
  struct Open {
    PolynomialPart part;
    double error = 0.0;  ///< 0: resolved
    int depth = 0;
  };
  std::vector<Open> parts_;  ///< of the expression: a heap, the least resolved first
};

}  // namespace pwlsim::measure
