#pragma once
/// The complementarity problem of a stage by a primal-dual interior point method on the sparse system (Mehrotra, SIAM J. Optim. 2, 1992), for
/// monotone problems, which those of passive networks are: some twenty factorisations, however many ports are in dispute and however many ties there
/// are.
///
/// Every diode is a resistor s/u in turn: its closing row is  u ds + s du = σ μ − u s,  so that an iteration is one solution of a linear circuit.

#include "engine/sparse/factors.hpp"
#include "engine/sparse/stage.hpp"

namespace pwlsim::engine::sparse {

class InteriorPoint {
 public:
  InteriorPoint(const Descriptor& descriptor, const linalg::KluOrdering& ordering) : descriptor_(descriptor), factor_(ordering) {}

  /// The position of the diodes in the solution, of two that a port allows the one that it is nearer to; switches stay as they are in `on`.
  /// `scale`: largest u and s of the run.
  /// False: it does not converge, and where the network is passive there is no solution.
  [[nodiscard]] bool solve(const Stage& stage, const PortScale& scale, Position& on);

 private:
  /// A diode, of those that may conduct.
  [[nodiscard]] bool is_free(std::size_t port) const { return port < is_free_.size() && is_free_[port] != 0; }
  void start(const Stage& stage, const Position& on);
  [[nodiscard]] bool factor(const Stage& stage, const Position& on);
  void take_residuals(const Stage& stage, const Position& on);
  void direction(double target, bool corrected);
  [[nodiscard]] double longest() const;
  [[nodiscard]] double gap(double length) const;
  [[nodiscard]] bool is_decided() const;
  void take_position(const Stage& stage, const std::vector<double>& of_u, const std::vector<double>& of_s, Position& on) const;

  const Descriptor& descriptor_;
  linalg::KluFactor factor_;
  double unit_ = 1.0;
  Descriptor::Closing closing_;
  std::vector<double> values_;
  std::vector<double> step_, z_, residual_, move_;         ///< z − z0, z, what the equations miss, and the direction
  std::vector<double> u_, s_, du_, ds_, miss_u_, miss_s_;  ///< one a diode
  std::vector<double> last_u_, last_s_;                    ///< before the last iteration
  std::vector<char> is_free_;                              ///< likewise
  bool factored_ = false;
};

}  // namespace pwlsim::engine::sparse
