#pragma once
/// The impulses of an instant, linearised: a jump from x⁻ to P x⁻ gives an output the impulse Q = q·x⁻, q = (input of the output)·L·(P − I), L from a jump of the
/// state to the impulses of the ports (model/impulse.hpp). A small input changes it by q·(δx + ẋ δt), and moves it by δt.

#include <vector>

#include "engine/exact/observer.hpp"
#include "linalg/dense.hpp"
#include "model/system.hpp"

namespace pwlsim::steady {

struct OutputImpulse {
  std::size_t way = 0;    ///< number of the mode on the way of the change
  int output = 0;         ///< of the island
  Eigen::RowVectorXd on;  ///< q, of (ξ, ζ)
  double rate = 0.0;      ///< q·ẋ, 1/s
  double size = 0.0;      ///< Q
};

struct Impulses {
  std::vector<OutputImpulse> list;
  std::vector<int> unknown;  ///< outputs whose impulses are of higher order, or not proportional to the jump
};

/// Of a change with a state before it.
[[nodiscard]] Impulses impulses_of(const model::System& system, const engine::Change& change);

}  // namespace pwlsim::steady
