#pragma once
/// One implicit stage with its complementarity conditions, in increments:
///    (shift·E + G) (z − z0) = r,   0 ≤ u ⊥ s ≥ 0 at every diode,
/// r what the equations miss at z0. Rates come from the increment, so that they keep their digits however small the step.
///
/// Newton's method for min(u, s) = 0 on the sparse system: all ports whose sign is wrong change sides at once, from the position before
/// (Aganagić 1984; two or three factorisations for M-matrices). Where it comes back to a position it has left, the ports that changed sides
/// are in dispute, and lcp::solve decides among them on their dense port matrix, of at most `most_disputed` ports; where that is not enough and the
/// network is passive, an interior point method on the sparse system does (interior_point.hpp).

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <unordered_set>
#include <vector>

#include "engine/sparse/factors.hpp"
#include "engine/sparse/stage.hpp"

namespace pwlsim::engine::sparse {

inline constexpr std::size_t most_disputed = 300;

enum class Solved { yes, singular, no_position };
/// The methods for finding a position: none, Newton's method alone, or all.
enum class Search { none, newton, all };

class InteriorPoint;
class RestingParts;

class PortSolver {
 public:
  /// `voltage`: of the sources, a first scale.
  PortSolver(const Descriptor& descriptor, Factors& factors, double voltage);
  ~PortSolver();

  /// `on`: position to start from, then the one found. `step`: z − z0.
  [[nodiscard]] Solved solve(const Stage& stage, Position& on, std::vector<double>& step, std::vector<double>& z,
                             Search search = Search::all);
  /// The same with the position kept, whatever the signs. `no_position`: it contradicts the network.
  [[nodiscard]] Solved solve_in(const Stage& stage, const Position& on, std::vector<double>& step, std::vector<double>& z);
  /// r := (shift·E + G)⁻¹ r in a position.
  [[nodiscard]] Solved respond(double shift, const Position& on, std::vector<double>& r);
  /// Takes the port quantities of an accepted step into the scale.
  void note_scale(const std::vector<double>& z, const std::vector<double>& w);
  /// Rounding of inputs is from now on that of the terms of all rows: a voltage that does not reach a port makes no current there, as large as it may be.
  void judge_by_rows() { by_rows_ = true; }
  void note_voltage(double voltage) {
    scale_.slack = std::max(scale_.slack, voltage);
    held_voltage_ = std::max(held_voltage_, voltage);
  }
  [[nodiscard]] const PortScale& scale() const { return scale_; }
  /// What the sign of an input counts against: the largest of the last accepted step, and `most`, of a step beyond it. Not that of the run: what a
  /// surge leaves behind flows for long. No more than what resistors carry that alone meet it, where voltages are at most so large.
  [[nodiscard]] double input_size(std::size_t port, const Position& on, double most, double voltage) const;
  /// What the rounding of voltages of that size makes of the input of a port that is on: that much of its response to a voltage of its own.
  [[nodiscard]] double rounding_of_input(double shift, const Position& on, std::size_t port, double voltage);
  [[nodiscard]] double largest_voltage(const std::vector<double>& z) const;
  [[nodiscard]] std::uint64_t pivots() const { return pivots_; }
  /// Ports that no position satisfied, after `no_position`.
  [[nodiscard]] const std::vector<int>& disputed() const { return disputed_; }
  /// After `no_position`, where the position contradicts the network: what resolving that by force would change of the unknowns, else null.
  [[nodiscard]] const std::vector<double>* strain() const { return contradicted_ ? &strain_ : nullptr; }

 private:
  [[nodiscard]] Solved solve_at(const Stage& stage, const Position& on, std::vector<double>& step, std::vector<double>& z);
  void close(const Stage& stage, const Position& on, const std::vector<double>& z, const Descriptor::Closing* closing,
             std::vector<double>& right) const;
  [[nodiscard]] bool is_noisy(double shift) const;
  void correct(double shift, const Position& on, const Factor& factor, std::vector<double>& step);
  [[nodiscard]] double backward_error(const std::vector<double>& x, std::vector<double>& residual);
  void block(const Position& on, const std::vector<double>& from, std::vector<double>& step, std::vector<double>& z) const;
  void examine_ties(const Stage& stage, const Position& on, const Factor& factor, std::vector<double>& step, std::vector<double>& z);
  void take_out_open(const Position& on, const Factor& factor, const linalg::Vector& values,
                     std::initializer_list<std::vector<double>*> from) const;
  void refine(const Stage& stage, const Position& on, const Factor& factor, std::vector<double>& step, std::vector<double>& z);
  struct Sizes {
    double voltage, current;  ///< both in volts
  };
  [[nodiscard]] Sizes sizes(const std::vector<double>& z) const;
  [[nodiscard]] double rounding_by_rows(const Stage& stage, const Position& on, std::size_t port, const std::vector<double>& z);
  void measure_rows(const Stage& stage, const Position& on, const std::vector<double>& z);
  [[nodiscard]] double rounding_at_nodes(std::size_t port, const Position& on) const;
  [[nodiscard]] bool is_idle(std::size_t port, const Position& on);
  [[nodiscard]] std::vector<int> violated(const Stage& stage, const Position& on, const std::vector<double>& z, double tolerance);
  [[nodiscard]] Solved iterate(const Stage& stage, double tolerance, Position& on, std::vector<double>& step, std::vector<double>& z);
  [[nodiscard]] Solved settle_by_interior(const Stage& stage, Position& on, std::vector<double>& step, std::vector<double>& z);
  [[nodiscard]] Solved settle_dispute(const Stage& stage, Position& on, std::vector<double>& step, std::vector<double>& z);
  [[nodiscard]] bool decide(const Stage& stage, Position& on, const std::vector<double>& z);
  [[nodiscard]] Solved found(const Stage& stage, const Position& on, const std::vector<double>& z);
  void dispute(const std::vector<int>& ports);

  const Descriptor& descriptor_;
  Factors& factors_;
  bool passive_;
  double voltage_;  ///< of the sources
  PortScale scale_;
  double held_voltage_ = 0.0;                         ///< of sources and initial values
  double present_input_ = 0.0, present_slack_ = 0.0;  ///< largest of the last accepted step
  std::vector<int> disputed_;
  std::vector<double> right_, refined_, residual_, sizes_, values_, probe_, row_sizes_;
  std::unique_ptr<InteriorPoint> interior_;  ///< once it is needed
  std::unique_ptr<RestingParts> resting_;    ///< likewise
  Position idle_on_;                         ///< the position in which idle_ is known
  std::vector<char> idle_;
  std::uint64_t pivots_ = 0;
  bool by_rows_ = false;
  bool repeated_ = false;  ///< Newton's method came back to a position
  std::vector<double> strain_;
  bool contradicted_ = false;  ///< the last position holds only because of its factor's ε
};

}  // namespace pwlsim::engine::sparse
