#pragma once
/// One implicit stage with its complementarity conditions:  (shift·E + G) z = r + b(w),  0 ≤ u ⊥ s ≥ 0 at every diode.
///
/// Newton's method for min(u, s) = 0 on the sparse system: all ports whose sign is wrong change sides at once, from the position before
/// (Aganagić 1984; two or three factorisations for M-matrices). Where it comes back to a position it has left, the ports that changed sides
/// are in dispute, and lcp::solve decides among them on their dense port matrix, of at most `most_disputed` ports.

#include <algorithm>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "engine/sparse/factors.hpp"

namespace pwlsim::engine::sparse {

inline constexpr std::size_t most_disputed = 300;

enum class Solved { yes, singular, no_position };

/// Largest port quantities of the run so far, in volts: what signs are judged against.
struct PortScale {
  double input = 0.0, slack = 0.0;
};

class PortSolver {
 public:
  /// `voltage`: of the sources, a first scale.
  PortSolver(const Descriptor& descriptor, Factors& factors, double voltage)
      : descriptor_(descriptor), factors_(factors), passive_(descriptor.passive()), scale_{0.0, voltage} {}

  /// `on`: position to start from, then the one found. `memory`: r.
  [[nodiscard]] Solved solve(double shift, const std::vector<double>& memory, const std::vector<double>& w, Position& on,
                             std::vector<double>& z);
  /// The same with the position kept, whatever the signs.
  [[nodiscard]] Solved solve_at(double shift, const std::vector<double>& memory, const std::vector<double>& w, const Position& on,
                                std::vector<double>& z);
  /// r := (shift·E + G)⁻¹ r in a position.
  [[nodiscard]] Solved respond(double shift, const Position& on, std::vector<double>& r);
  /// The variable of port p that its position leaves free: u where on, s where off. A diode needs it not negative.
  [[nodiscard]] double free_variable(std::size_t port, bool on, const std::vector<double>& z, const std::vector<double>& w) const;
  /// Takes the port quantities of an accepted step into the scale.
  void note_scale(const std::vector<double>& z, const std::vector<double>& w);
  void note_voltage(double voltage) { scale_.slack = std::max(scale_.slack, voltage); }
  [[nodiscard]] const PortScale& scale() const { return scale_; }
  [[nodiscard]] std::uint64_t pivots() const { return pivots_; }
  /// Ports that no position satisfied, after `no_position`.
  [[nodiscard]] const std::vector<int>& disputed() const { return disputed_; }

 private:
  [[nodiscard]] std::vector<int> violated(const Position& on, const std::vector<double>& z, const std::vector<double>& w, double tolerance);
  [[nodiscard]] Solved settle_dispute(double shift, const std::vector<double>& memory, const std::vector<double>& w, Position& on,
                                      std::vector<double>& z);
  [[nodiscard]] bool decide(double shift, Position& on, const std::vector<double>& z, const std::vector<double>& w);
  [[nodiscard]] bool held() const;
  void dispute(const std::vector<int>& ports);

  const Descriptor& descriptor_;
  Factors& factors_;
  bool passive_;
  PortScale scale_;
  std::vector<int> disputed_;
  std::vector<double> right_;
  std::uint64_t pivots_ = 0;
  double forced_ = 0.0;  ///< of the last solution: what should be zero, relative to its scale
};

}  // namespace pwlsim::engine::sparse
