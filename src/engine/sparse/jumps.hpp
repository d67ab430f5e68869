#pragma once
/// The jumps at an instant, in the form of the exact engine.

#include "engine/run.hpp"
#include "engine/sparse/part.hpp"
#include "engine/sparse/stepper.hpp"

namespace pwlsim::engine::sparse {

/// States of a jump one by one, in the order of Descriptor::states and as State::measure has them.
struct JumpEnds {
  double time;
  const std::vector<double>& before;
  const std::vector<double>& after;
};

/// The two implicit Euler steps of length h that took it: the first holds the impulses, the second what flows anyway.
struct JumpSteps {
  double h;
  const Point& first;
  const Point& second;
};

/// Changes below `share` of a state and impulses below that part of what some store took are left out: errors of the steps.
[[nodiscard]] Jump describe_jump(const Part& part, const JumpEnds& ends, const JumpSteps& steps, double share);

}  // namespace pwlsim::engine::sparse
