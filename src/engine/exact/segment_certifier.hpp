#pragma once
/// The run's certificate: residuals of the original equations, evaluated on samples of the solution.

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/exact/exact_model.hpp"
#include "engine/exact/locator.hpp"
#include "engine/exact/recorder.hpp"

namespace pwlsim::engine {

/// Keeps the first segment of every mode and an evenly thinned sample of the others, and checks them after the run:
///
///  - complementarity: |min(u_i, y_i)| of diodes (and the variable a switch forces to zero) against the island's largest |u|, |y|;
///  - KCL/KVL: every row of F x + G z + H_a a + H_w ζ and of x' − S_x z against the largest sum of its terms' magnitudes over the
///    run (the rows before index reduction and before ports were chosen);
///  - energy: change of ½|x|² over an interval against ∫ Σ v·i dt of the stores by Gauss quadrature of z.
class SegmentCertifier : public Recorder {
 public:
  /// A segment that is examined.
  struct Sample {
    const IslandModel* island;
    const model::Mode* mode;
    std::vector<double> y0;
    double length;
  };

  void start_is_known(const IslandAt& island);
  void opens(const IslandAt& island, double length) {
    if (!island.run.is_open()) add(island.run.model(), island.run.segment(), length);
  }
  void ends_within(const IslandAt& island) {
    add(island.run.model(), island.run.segment(), std::max(0.0, island.time - island.run.segment().anchor));
  }
  [[nodiscard]] Certificate check() const;

 private:
  void add(const IslandModel& island, const Segment& segment, double length);

  std::vector<Sample> samples_;  ///< thinned
  std::vector<Sample> first_visits_;
  std::vector<std::pair<const IslandModel*, linalg::Vector>> starts_;
  std::uint64_t seen_ = 0, stride_ = 1;  ///< the latter a power of two
};

}  // namespace pwlsim::engine
