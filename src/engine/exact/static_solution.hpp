#pragma once
/// DC solution of one island with its sources frozen at ζ:  0 = A ξ + E ζ + B u,  y = C ξ + F ζ + D u,  0 ≤ u ⊥ y ≥ 0.

#include <vector>

#include "model/system.hpp"

namespace pwlsim::engine {

struct StaticSolution {
  enum class Status { solved, none };
  Status status = Status::solved;
  bool unique = true;  ///< false: some ξ is free; the least-energy one was taken
  double doubt = 0.0;  ///< of ξ, of its largest, by rounding
  linalg::Vector x;    ///< (ξ, ζ)
  linalg::Vector u;
};

/// `set`: active switch ports as wanted (diodes are chosen here). Candidates come from the rational complementarity problem as
/// s → 0, which tends to the least energy; the mode is then solved exactly and its signs checked.
[[nodiscard]] StaticSolution solve_static(const model::System& system, const linalg::Vector& zeta, const std::vector<char>& switch_active);

}  // namespace pwlsim::engine
