#pragma once
/// Derivatives of measured values, as what they read of the derivatives of signals: once for all parameters.

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/extreme_finder.hpp"
#include "analysis/transient.hpp"
#include "circuit/measurement.hpp"
#include "linalg/legendre.hpp"
#include "measure/expression_gradient.hpp"
#include "measure/measuring.hpp"
#include "steady/functional.hpp"
#include "steady/sensitivity.hpp"

namespace pwlsim::analysis {

/// A derivative that is another one on the other side of a kink.
struct TwoSided {
  double left = 0.0, right = 0.0;
  std::string kink;      ///< why they differ
  std::string failure;   ///< why there is none
  bool is_kink = false;  ///< there is one on each side, which is not known
  double noise = 0.0;    ///< left and right that differ by less, for a change by all of the parameter, are one: `measured`
  double measured = 0.0;
  [[nodiscard]] static TwoSided of(double value) { return {value, value, "", "", false, 0.0, value}; }
  [[nodiscard]] static TwoSided failed(std::string why) { return {0.0, 0.0, "", std::move(why), false, 0.0, 0.0}; }
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

/// A sum of what is read of the run's derivative, of the derivatives of numbers that cards hold, and of the run's begin and end.
struct MeasuredSum {
  steady::Functional run;
  double start_moves = 0.0, stop_moves = 0.0;
  std::vector<double> numbers;  ///< of each `.param` that is varied

  void add(double weight, const MeasuredSum& other);
  [[nodiscard]] bool is_empty() const;
};
/// The time by which that instant moves.
[[nodiscard]] MeasuredSum shift_of(std::size_t instant);

/// The derivative of one measurement.
struct MeasuredFunctional {
  MeasuredSum sum;
  /// weight·q counts where q·sign is positive on the side of smaller (−) or larger values of the parameter.
  struct Kink {
    MeasuredSum q;
    double weight = 0.0;
    int sign = 1;
    std::string why;
  };
  std::vector<Kink> kinks;
  /// There is no derivative to a parameter that moves `moves` and `against` differently.
  struct Obstacle {
    MeasuredSum moves, against;
    std::string why;
  };
  std::vector<Obstacle> obstacles;
  /// weight·(the largest, or the least, of values that are equal here).
  struct Tie {
    std::vector<MeasuredFunctional> places;
    double weight = 1.0;
    bool is_largest = true;
    double size = 0.0;  ///< of the values
    std::string why;
  };
  std::vector<Tie> ties;
  std::string failure;  ///< why there is none to any parameter; "" where there is

  void add(double weight, const MeasuredFunctional& other);
  /// Number of sums that are to be read.
  [[nodiscard]] std::size_t sums() const;
};

/// How one parameter moves what does not belong to the run.
struct DirectMoves {
  int number = -1;                             ///< of a `.param`; −1: it is none
  double start_moves = 0.0, stop_moves = 0.0;  ///< of the run's begin and end, s
};

class MeasuredFunctionals {
 public:
  MeasuredFunctionals(const MeasuredPass& run, const steady::Sensitivity& sensitivity);

  /// Valid as long as this.
  [[nodiscard]] const MeasuredFunctional& of(std::size_t measurement);

 private:
  using Kind = circuit::Measurement::Kind;
  using Side = steady::Side;
  /// An expression at one time: its value and rate, and what its derivative at that fixed time reads.
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
  /// The gradient of a polynomial of second degree in the signals, read at every point of a run: g + H·s.
  struct AffineGradient {
    std::vector<double> constant, slopes;  ///< slopes: row by row; both empty: it is none
  };
  [[nodiscard]] AffineGradient affine_gradient(const circuit::MeasuredExpression& expression, bool squares) const;
  void add_inside(const measure::ExpressionGradient& gradient, const AffineGradient& affine, std::size_t piece, double from, double to,
                  bool squares, double scale, MeasuredFunctional& sum);
  [[nodiscard]] bool add_stretch(const circuit::Measurement& measurement, const measure::Place& place, double scale,
                                 MeasuredFunctional& sum);
  void add_instants(const circuit::Measurement& measurement, const measure::Place& place, bool squares, double scale,
                    MeasuredFunctional& sum);
  void add_extreme(double weight, std::size_t measurement, bool is_largest, MeasuredFunctional& sum);
  [[nodiscard]] MeasuredFunctional of_extreme(const circuit::Measurement& measurement, double time, bool is_largest,
                                              const measure::Place& place);
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
  measure::GradientValue read_;  ///< of an integral: results and numbers, added up
};

/// Reads sums along one parameter that has been followed forward.
class ForwardReader {
 public:
  ForwardReader(const MeasuredPass& run, const steady::Sensitivity& sensitivity, const steady::Followed& followed, std::size_t parameter,
                DirectMoves direct)
      : run_(run), sensitivity_(sensitivity), followed_(followed), parameter_(parameter), direct_(direct) {}

  [[nodiscard]] double read(const MeasuredSum& sum);

 private:
  [[nodiscard]] double read(const steady::Functional& functional);

  const MeasuredPass& run_;
  const steady::Sensitivity& sensitivity_;
  const steady::Followed& followed_;
  std::size_t parameter_;
  DirectMoves direct_;
  std::map<std::size_t, std::vector<std::vector<double>>> points_;  ///< of a piece: derivatives of the probes at its points
};

/// The derivative by what `read` makes of each of its sums.
[[nodiscard]] TwoSided two_sided(const MeasuredFunctional& functional, const std::function<double(const MeasuredSum&)>& read);
/// What does not belong to the run.
[[nodiscard]] double read_direct(const MeasuredSum& sum, const DirectMoves& direct);

}  // namespace pwlsim::analysis
