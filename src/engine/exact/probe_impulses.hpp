#pragma once
/// Integrals of the probed signals over an instant: of the ports' impulses and of jumps of the sources. An integral that is rounding of the terms
/// in its sum is zero.

#include <vector>

#include "engine/exact/exact_model.hpp"
#include "engine/exact/recorder.hpp"
#include "engine/run.hpp"

namespace pwlsim::engine {

class ProbeImpulses : public Recorder {
 public:
  ProbeImpulses(const std::vector<IslandModel>& islands, const Probes& probes);

  void opened(const IslandAt& island, const Opening& /*opening*/) {
    if (!shares_[island.number].empty()) keep(island);
  }
  void sources_jumped(const IslandAt& island) {
    if (!shares_[island.number].empty()) add_edges(island);
  }
  void selected(const IslandAt& island, const model::Selected& selected) {
    if (selected.jumps > 0) add_impulses(island.number, selected);
  }
  void settled(double time, bool impulses_count) {
    if (any_) pass_on(time, impulses_count);
  }

 private:
  void keep(const IslandAt& island);
  void add_edges(const IslandAt& island);
  void add_impulses(std::size_t island, const model::Selected& selected);
  void pass_on(double time, bool impulses_count);

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
