#pragma once
/// The derivative of a run to a parameter, along the run: x_p' = A x_p + (contributions of the parameter's inputs), at instants
///
///     x_p⁺ = P x_p⁻ + P_w w + (P f⁻ − f⁺)·t_p,   t_p = −(n x_p + n_w w)/(n f⁻), or known if a source's edge or a threshold moves.
///
/// Between instants state, inputs and derivative are one linear system, whose exponential is exact. The inputs w of a parameter are multiples of signals
/// (steady/parameter_inputs.hpp), or functions of time (steady/wave.hpp).

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "steady/functional.hpp"
#include "steady/linearised.hpp"
#include "steady/parameter_inputs.hpp"
#include "steady/wave.hpp"

namespace pwlsim::steady {

/// Of one parameter.
struct Followed {
  std::vector<Vector> begins;  ///< derivative of c at the start of each segment, followed by the sources of the waves
  std::vector<double> shifts;  ///< dt/dp of each instant, s
  Vector end;                  ///< derivative of the stacked ξ at the end, whose time is fixed
  std::string failure;         ///< why there is none; "" if there is one
  bool is_kink = false;        ///< the derivative differs for larger and smaller values: the parameter separates coinciding events

  void fail(std::string why, bool kink) {
    if (!failure.empty()) return;
    failure = std::move(why);
    is_kink = kink;
  }
};

/// A signal at one time and its derivative to time.
struct SignalJet {
  double value = 0.0, rate = 0.0;
};
/// The derivative of a signal to a parameter at a fixed time, and its derivative to time.
struct MovedJet {
  double moved = 0.0, moved_rate = 0.0;
};

class Sensitivity {
 public:
  /// `orbit`: of the trace, with the names of `inputs`. `is_settled`: its sources have always been periodic. All must outlive this.
  Sensitivity(const engine::ExactModel& model, const Trace& trace, const LinearisedOrbit& orbit, const SensitivityInputs& inputs,
              bool is_settled);

  /// Starts from the derivative `start` of the stacked ξ just before t = 0.
  [[nodiscard]] Followed follow(std::size_t parameter, const Vector& start) const { return follow(parameter, start, segments_.size()); }
  /// Whether some diode carries and blocks nothing throughout a segment: then what a parameter makes of it decides the mode on each side of its value.
  [[nodiscard]] bool has_rests() const { return !rests_.empty(); }
  /// The same as far as the last of these segments: a failure tells of a parameter that ends such a rest.
  [[nodiscard]] Followed follow_to_last_rest(std::size_t parameter, const Vector& start) const;
  /// Signals of the model at a time of the run; of the time of an instant on that side.
  [[nodiscard]] std::vector<SignalJet> signals_at(const std::vector<int>& signals, double time, Side side) const;
  /// Their derivatives to a parameter.
  [[nodiscard]] std::vector<MovedJet> moved_signals_at(const Followed& followed, std::size_t parameter, const std::vector<int>& signals,
                                                       double time, Side side) const;
  /// Derivatives of the signals at the points of Gauss and Legendre on [begin, begin + length], in the segment that `inside` lies in, whose motion may go
  /// on behind its end: values[point][signal]. To be asked for the same signals each time.
  [[nodiscard]] std::vector<std::vector<double>> moved_at(const Followed& followed, std::size_t parameter, const std::vector<int>& signals,
                                                          double inside, double begin, double length) const;
  /// ∫ over the stretch of its signals' derivatives.
  [[nodiscard]] double moved_over(const Followed& followed, std::size_t parameter, const std::vector<int>& signals,
                                  const Functional::Stretch& stretch) const;
  /// Whether one of the signals may jump at the instant, beyond rounding.
  [[nodiscard]] bool may_jump(std::size_t instant, const std::vector<int>& signals) const;
  [[nodiscard]] const LinearisedOrbit& orbit() const { return orbit_; }
  /// "S1 opens at t = 2e-3 s".
  [[nodiscard]] std::string instant_text(std::size_t instant) const;
  [[nodiscard]] bool is_settled() const { return is_settled_; }

 private:
  friend class Adjoint;
  struct Segment {
    std::size_t island = 0;
    const model::Mode* mode = nullptr;
    double begin = 0.0, length = 0.0;
    const std::vector<double>*y0 = nullptr, *y1 = nullptr;
    [[nodiscard]] double end() const { return begin + length; }
    [[nodiscard]] double inside() const { return begin + 0.5 * length; }
  };
  /// The equations of a parameter in one mode: (y, z, c_p)' = block·(y, z, c_p).
  struct Flow {
    std::vector<std::size_t> waves;        ///< of the parameter, in this island
    int ny = 0, nz = 0;                    ///< y without the inputs, which are zero along the run
    Matrix source;                         ///< (y, z)′
    std::vector<Eigen::RowVectorXd> rows;  ///< w of each input = row·(y, z); empty: zero
    Matrix outputs;                        ///< of the island: what (y, z) adds to C c_p
    std::unique_ptr<linalg::Exponential> block;
    std::unique_ptr<linalg::Exponential> signals;  ///< of (y, z); with the waves of all parameters only
    double scale = 1.0;                            ///< of c_p within the block
    /// Of a stretch that recurs: the signals at its points, from the state at its begin.
    struct Points {
      int uses = 0;
      Matrix rows;
    };
    mutable std::map<double, Points> points;
    /// A row of (y, z) that gives that derivative of an input which it has a row for.
    [[nodiscard]] Eigen::RowVectorXd derivative(std::size_t input, int order) const;
    /// Its rows, once they are worth it; else none.
    const Matrix& rows_at_points(double length, const Matrix& read) const;
    /// Of (y, z, c_p) with the integral of what the row reads of it behind it.
    struct Integral {
      Eigen::RowVectorXd row;
      double scale = 1.0;  ///< of the integral within the block
      std::unique_ptr<linalg::Exponential> block;
    };
    mutable std::vector<Integral> integrals;
  };

  /// Of (y, z), made as they are asked for.
  class Derivatives {
   public:
    Derivatives(const Matrix& source, Vector yz) : source_(source), known_{std::move(yz)} {}
    [[nodiscard]] const Vector& operator()(int order) {
      while (static_cast<int>(known_.size()) <= order) known_.push_back(source_ * known_.back());
      return known_[static_cast<std::size_t>(order)];
    }

   private:
    const Matrix& source_;
    std::deque<Vector> known_;
  };

  /// So many segments.
  [[nodiscard]] Followed follow(std::size_t parameter, const Vector& start, std::size_t segments) const;
  void find_kept_sources();
  void find_jumping_sources(const engine::IslandModel& island);
  void add(const TraceSegment& segment);
  void find_rests(std::size_t segment);
  void check_rests(std::size_t parameter, std::size_t segment, Followed& followed) const;
  /// y without the inputs.
  [[nodiscard]] Vector seen(std::size_t island, const model::Mode& mode, const double* y) const;
  [[nodiscard]] Eigen::RowVectorXd seen_row(std::size_t island, const model::Mode& mode, const Eigen::RowVectorXd& row) const;
  void add_static_parts();
  [[nodiscard]] std::string check(std::size_t parameter) const;
  [[nodiscard]] bool has_unknown_derivatives(const ParameterInputs& parameter) const;
  /// The number behind the last one: the waves of all parameters together.
  [[nodiscard]] const ParameterInputs& inputs_of_number(std::size_t parameter) const {
    return parameter < inputs_.parameters.size() ? inputs_.parameters[parameter] : all_;
  }
  /// Where the waves of a parameter begin among those of all that the island reads.
  [[nodiscard]] int first_of_waves(std::size_t parameter, std::size_t island) const;
  [[nodiscard]] bool is_read(int input, std::size_t island) const {
    return orbit_.columns(island, static_cast<std::size_t>(input)).value >= 0;
  }
  [[nodiscard]] const Flow& flow_of(std::size_t parameter, std::size_t island, const model::Mode& mode) const;
  void add_drives(std::size_t parameter, std::size_t island, const model::Mode& mode, Flow& flow) const;
  [[nodiscard]] Eigen::RowVectorXd drive_row(const Drive& drive, std::size_t island, const model::Mode& mode) const;
  [[nodiscard]] Vector waves_at(const Flow& flow, std::size_t parameter, double time, double inside) const;
  [[nodiscard]] Vector at(const Flow& flow, const Segment& segment, const Vector& begin, double since) const;
  [[nodiscard]] Vector begin_of(std::size_t parameter, const Segment& segment, const Vector& xi) const;
  [[nodiscard]] Vector inputs_of(const Flow& flow, std::size_t island, const Matrix& columns, int first, const Vector& yz) const;
  void pass_segment(std::size_t parameter, std::size_t number, Vector& xi, Followed& followed) const;
  void pass_instant(std::size_t parameter, std::size_t number, Vector& xi, Followed& followed) const;
  [[nodiscard]] double shift_of(std::size_t parameter, std::size_t number, const Vector& xi, Followed& followed) const;
  /// An instant with only a corner of a source: it affects measurements there, but no state.
  [[nodiscard]] double corner_shift_of(std::size_t parameter, const LinearInstant& instant) const;
  [[nodiscard]] double level_shift_of(std::size_t parameter, const LinearGuard& guard) const;
  [[nodiscard]] double inputs_on(const LinearGuard& guard, const Flow& flow, const Vector& yz) const;
  [[nodiscard]] double passage_of(std::size_t parameter, std::size_t number, const LinearGuard& guard, const Vector& xi) const;
  void check_beside(std::size_t parameter, std::size_t number, double shift, const Vector& xi, Followed& followed) const;
  [[nodiscard]] std::optional<double> edge_shift_of(std::size_t parameter, double time, Followed& followed) const;
  [[nodiscard]] double clock_shift_of(std::size_t parameter, const LinearGuard& guard, double time) const;
  [[nodiscard]] double driven_by(const Drive& drive, double time) const;
  [[nodiscard]] std::string name_of(const LinearGuard& guard) const;
  void check_changes(std::size_t number, Followed& followed) const;
  [[nodiscard]] std::vector<Vector> states_by_way(const engine::Change& change) const;
  void check_others(std::size_t parameter, const LinearInstant& instant, Followed& followed) const;
  void pass_change(std::size_t parameter, const engine::Change& change, const LinearChange& linear, double time, double shift,
                   Vector& xi) const;
  [[nodiscard]] const Flow::Integral& integral_of(const Flow& flow, const Eigen::RowVectorXd& row) const;
  [[nodiscard]] const Segment* segment_at(std::size_t island, double time, Side side) const;
  using Share = std::pair<Eigen::Index, std::size_t>;
  /// Outputs of an island that are parts of signals: the output's row, and the place among `signals`.
  [[nodiscard]] std::vector<Share> shares_of(std::size_t island, const std::vector<int>& signals) const;

  const engine::ExactModel& model_;
  const Trace& trace_;
  const LinearisedOrbit& orbit_;
  const SensitivityInputs& inputs_;
  bool is_settled_;
  TraceStep wrap_;                               ///< the begin of a period, with its end on the left
  std::vector<std::vector<Eigen::Index>> kept_;  ///< of each island: sources that are no inputs
  ParameterInputs all_;                          ///< waves alone
  std::vector<char> sound_;                      ///< parameters that can be followed
  std::vector<char> read_to_the_last_;           ///< inputs of which something may follow more derivatives than are known
  double length_ = 0.0;
  std::vector<Segment> segments_;
  std::size_t static_first_ = 0;                     ///< segments of parts with only sources, which runs do not report
  std::deque<std::vector<double>> sources_;          ///< their y
  std::vector<std::size_t> first_;                   ///< segment that ends at instant i; the last: of the tail
  std::map<std::size_t, std::vector<int>> rests_;    ///< diodes at rest, by segment
  std::vector<std::vector<std::size_t>> of_island_;  ///< its segments in order
  std::vector<std::map<std::string, Eigen::RowVectorXd>> stores_;
  std::vector<Wave> jumping_;  ///< sources of the model that may jump, without derivatives
  mutable std::map<std::pair<std::size_t, const model::Mode*>, Flow> flows_;
};

}  // namespace pwlsim::steady
