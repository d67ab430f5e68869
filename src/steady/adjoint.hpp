#pragma once
/// Derivatives of one measurement to all parameters at once, backwards along the run:
///
///     λ′ = −A′λ − c,   λ⁻ = P′λ⁺ + on_state′σ,   σ = d·λ⁺ + (what the measurement reads of the instant's shift),
///
/// λ jumps by the measurement's weights of the signals at each of its points; c is a weight over time (an average). A parameter's inputs w = row·(y, z) then contribute ∫ λ′(b w + b₁ w′) dt, for
/// which one matrix ∫ λ (y, z)′ dt per mode serves all parameters: it is linear in λ y′ at the ends of intervals, which are added up over all intervals of
/// one length. With c these are those of (λ, 1), whose last row is ∫ (y, z)′ dt.
///
/// Cao, Li, Petzold & Serban, Adjoint sensitivity analysis for differential-algebraic equations, SIAM J. Sci. Comput. 24 (2003), for the method; the
/// instants are the transpose of steady/sensitivity.hpp.

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "steady/functional.hpp"
#include "steady/sensitivity.hpp"

namespace pwlsim::steady {

class Adjoint {
 public:
  /// `sensitivity` must outlive this. `signals`: those with weights in functionals.
  Adjoint(const Sensitivity& sensitivity, std::vector<int> signals);

  /// What the functional reads is d·(derivative of the start), for a parameter that moves nothing else.
  [[nodiscard]] Vector to_start(const Functional& functional, const Vector& end) const;
  /// The functional, and `end` weighing the state at the end, of the derivative to each parameter from a start that does not move.
  struct Read {
    std::vector<double> values;  ///< of each parameter; 0 if it cannot be followed
    Vector start;                ///< contribution of a start that changes: start·x_p(0)
  };
  [[nodiscard]] Read read(const Functional& functional, const Vector& end) const;
  /// Why a parameter cannot be followed; "" if it can.
  [[nodiscard]] const std::string& failure(std::size_t parameter) const { return failures_[parameter]; }
  /// Whether the reason is that the parameter separates coinciding events: there is one derivative on each side.
  [[nodiscard]] bool is_kink(std::size_t parameter) const { return kinks_[parameter] != 0; }
  /// Whether it can be followed forward only: its edges coincide with other events.
  [[nodiscard]] bool is_forward_only(std::size_t parameter) const { return forward_only_[parameter] != 0; }

 private:
  /// Sums of λ y′ at intervals of nearly one length.
  struct Lengths {
    double length = 0.0;
    int density = -1;
    Matrix sum;  ///< of (λ, 1) where there is a density
  };
  /// Sums of weight·(y, z)′ of intervals of one length, (y, z) at their begin: a row for each point and output of the island. From where they are known
  /// what the points bring is made once for all of them.
  struct Spread {
    double length = 0.0;
    int uses = 0;
    Matrix sum, injection;  ///< injection: λ at the begin for a unit of each weight
  };
  /// The same for intervals of about one length: their contribution is an analytic function of the length, which is interpolated between a few lengths.
  struct Range {
    std::int64_t number = 0;  ///< its lengths are those from number·width on
    int uses = 0;
    std::vector<Spread> nodes;
  };
  /// Of one density in one mode.
  struct Even {
    std::vector<std::pair<Eigen::Index, double>> outputs;  ///< row and weight
    Matrix a;                                              ///< (A 0; c′/scale 0): its transpose moves (λ, scale) backwards
    double scale = 1.0;
    linalg::Exponential backward;
  };
  /// Sums over one mode of what multiplies the columns of its inputs; w = row·(y, z) is known by parameter only at the end.
  struct Sums {
    Matrix moment;               ///< ∫ λ (y, z)′ dt: n₁ rows
    Matrix outputs;              ///< Σ weight·(y, z)′ of each output
    Matrix jump, lift;           ///< Σ λ (y, z)′ where the mode's projector or its lift takes inputs: n rows
    std::vector<Matrix> inputs;  ///< of w and its derivatives themselves, where they move an instant: a row an input
    std::vector<Lengths> lengths;
    std::vector<Spread> spreads;
    std::map<std::int64_t, Range> ranges;
    double width = -1.0;  ///< of the ranges, s; negative: not known yet
  };
  struct Pass {
    Vector lambda;
    bool collects = true;
    std::map<std::pair<std::size_t, const model::Mode*>, Sums> sums;
    std::vector<double> shifts;          ///< σ of each instant
    std::map<std::size_t, double> read;  ///< the measurement's weights of the instants' shifts
    /// Weights of the signals over intervals of time, which do not overlap.
    struct Density {
      double begin = 0.0, end = 0.0;
      std::vector<double> weights;
    };
    std::vector<Density> densities;  ///< in order of time
    std::map<std::pair<const model::Mode*, int>, Even> even;
  };
  struct Injection {
    double since = 0.0;  ///< s from the begin of the segment
    Vector weight;       ///< of c
  };

  using Injections = std::map<std::size_t, std::vector<Injection>>;

  [[nodiscard]] const Sensitivity::Flow& flow(std::size_t island, const model::Mode& mode) const;
  [[nodiscard]] Sums& sums_of(Pass& pass, std::size_t island, const model::Mode& mode) const;
  [[nodiscard]] const Vector& begin_of(const Sensitivity::Segment& segment) const;
  /// (y, z) of a mode at y; `inside`: a time at which its waves are those in force, s.
  [[nodiscard]] Vector signals_of(std::size_t island, const model::Mode& mode, const double* y, double time, double inside) const;
  [[nodiscard]] Vector later(const Sensitivity::Segment& segment, Vector yz, double since) const;
  void examine(std::size_t parameter);
  void run(const Functional& functional, const Vector& end, Pass& pass) const;
  void take_points(const Functional& functional, Pass& pass, Injections& injections) const;
  void take_interval(const Functional::Interval& interval, Pass& pass, Injections& injections) const;
  [[nodiscard]] Vector of_range(const Sensitivity::Segment& segment, const Functional::Interval& interval, double since, double width,
                                Range& range, bool collects) const;
  [[nodiscard]] Vector point_by_point(const Sensitivity::Segment& segment, const Functional::Interval& interval, double since, Sums& sums,
                                      Pass& pass) const;
  [[nodiscard]] Spread* spread_of(const Sensitivity::Segment& segment, double length, Sums& sums) const;
  [[nodiscard]] Range* range_of(const Sensitivity::Segment& segment, double length, Sums& sums) const;
  void fill(const Sensitivity::Segment& segment, Spread& spread) const;
  [[nodiscard]] Vector weights_of(std::size_t island, const Functional::Interval& interval) const;
  void settle(std::size_t island, const model::Mode& mode, const Spread& spread, Sums& sums) const;
  [[nodiscard]] const linalg::Exponential& backward_of(const model::Mode& mode) const;
  void pass_segment(std::size_t number, Injections& injections, Pass& pass) const;
  void pass_instant(std::size_t number, const Functional& functional, Pass& pass) const;
  void pass_ways(const engine::Change& change, double time, double right, Pass& pass) const;
  void collect_guard(const engine::Change& change, const LinearInstant& instant, double left, double sigma, Pass& pass) const;
  void take_stretches(const Functional& functional, Pass& pass) const;
  [[nodiscard]] const Even& even_of(const Sensitivity::Segment& segment, int density, Pass& pass) const;
  /// Over the part of a segment that begins `since` after its begin; `begin`: (y, z) at the segment's begin.
  void cross(const Sensitivity::Segment& segment, double since, double end, const Vector& begin, Vector& lambda, Pass& pass) const;
  void travel(const Sensitivity::Segment& segment, double length, const Vector& yz, Vector& lambda, Pass& pass, int density = -1) const;
  void settle(std::size_t island, const model::Mode& mode, Sums& sums, Pass& pass) const;
  [[nodiscard]] double of_parameter(std::size_t parameter, Pass& pass) const;
  [[nodiscard]] double of_edges(std::size_t parameter, const Pass& pass) const;

  const Sensitivity& along_;
  std::vector<int> signals_;
  std::vector<std::vector<Sensitivity::Share>> shares_;  ///< of each island
  std::vector<std::string> failures_;
  std::vector<char> forward_only_, kinks_;
  mutable std::vector<Vector> begins_;                                  ///< (y, z) at the begin of each segment; empty: not asked for yet
  mutable std::map<const model::Mode*, linalg::Exponential> backward_;  ///< of A′ of a mode's own coordinates
};

}  // namespace pwlsim::steady
