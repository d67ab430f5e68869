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
  /// The x of a time.
  [[nodiscard]] double place(double time) const { return 2.0 * (time - from) / length() - 1.0; }
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

  /// Passes parts of [from, to] to `take`, in order, on each of which the expression is a polynomial to `resolution` of `scale`. Where a condition changes or a
  /// function has a corner or a jump, a part ends; between such times the expression is subdivided until it is a polynomial and no function can have a feature that the
  /// points do not show. False: it varies too fast, and the parts that were passed are not valid. `for_integral`: only ∫ of the parts matters.
  bool resolve(const Program& program, const std::vector<double>& results, double from, double to, double scale,
               const std::function<void(const PolynomialPart&)>& take, bool for_integral = false);
  /// The zero of the expression near `time`, where the series of a part shows a sign change. Where the series is below `noise` for a while, as about the zero of x³, the sign of the expression itself decides.
  [[nodiscard]] double refined_zero(const Program& program, const std::vector<double>& results, const PolynomialPart& part, double time,
                                    double noise);

 private:
  [[nodiscard]] PolynomialPart part_on(const Program& program, const std::vector<double>& results, double from, double to);
  void split(const Program& program, const std::vector<double>& results, const PolynomialPart& whole, double& scale);
  [[nodiscard]] double error_of(const Program& program, const std::vector<double>& results, const PolynomialPart& part, double tail_before,
                                int depth, double scale, double& hidden);
  [[nodiscard]] bool touches(const Program& program, const std::vector<double>& results, const PolynomialPart& part, double time,
                             std::size_t nearest);
  void find_cuts(const Program& program, const std::vector<double>& results, double from, double to, std::size_t turn, int depth,
                 double tail_before);
  [[nodiscard]] std::vector<double> cuts_of(const Program& program, const std::vector<double>& results, std::size_t turn, double from,
                                            double to);
  void set_inputs(const Program& program, const std::vector<double>& results, double from, double to);
  void set_inputs(const Program& program, const std::vector<double>& results, const double& time);
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
  std::vector<double> turns_, turn_sizes_;
  HiddenFeatures hidden_;
  std::vector<double> cuts_;  ///< where parts end, s
  std::size_t looks_ = 0;     ///< for cuts of an expression
  bool is_overrun_ = false;   ///< there are more cuts than can be found
  struct Open {
    PolynomialPart part;
    double error = 0.0;   ///< 0: resolved
    double hidden = 0.0;  ///< how far it may vary between points; the error is this one
    int depth = 0;
    bool is_shortest = false;  ///< cannot be halved
  };
  std::vector<Open> parts_;  ///< of the expression between cuts: a heap, the least resolved first
};

}  // namespace pwlsim::measure
