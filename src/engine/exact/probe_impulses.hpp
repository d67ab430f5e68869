#pragma once
/// Integrals of the probed signals over an instant: of the ports' impulses and of jumps of the sources. An integral that is rounding of the terms
/// in its sum is zero.

#include <vector>

#include "engine/exact/exact_model.hpp"
#include "engine/run.hpp"
#include "model/selection.hpp"

namespace pwlsim::engine {

class ProbeImpulses {
 public:
  ProbeImpulses(const std::vector<IslandModel>& islands, const Probes& probes);

  /// The state x = (ξ, ζ) of an island left of the instant.
  void before(std::size_t island, const std::vector<double>& x);
  /// Its sources have jumped: ζ is now that after the instant.
  void sources_jumped(std::size_t island, const std::vector<double>& x);
  /// A selection in it has jumped.
  void ports_jumped(std::size_t island, const model::Selected& selected);
  /// The instant has ended; `wanted`: pass the impulses to the sink.
  void end(double time, bool wanted);

 private:
  struct Share {
    const model::OutputRow* row = nullptr;
    std::size_t probe = 0;
  };
  const std::vector<IslandModel>& islands_;
  const Probes& probes_;
  std::vector<std::vector<Share>> shares_;  ///< of each island
  model::Vector zeta_;
  /// What is added to a probe, a sum of so large terms.
  void add(std::size_t probe, double value, double terms);

  std::vector<double> values_, terms_;
  bool any_ = false;
};

}  // namespace pwlsim::engine
