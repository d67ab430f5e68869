#pragma once
/// Runs that differ only in the values of constant sources: the circuit is compiled and its model prepared once for all of them.

#include <memory>
#include <optional>
#include <span>

#include "analysis/prepared_engine.hpp"
#include "circuit/compile.hpp"
#include "engine/exact/exact.hpp"

namespace pwlsim::analysis {

class SteppedSources {
 public:
  /// `compiled` with `channels` sources held (CompileOptions::held). Empty if that is impossible: a channel has no source of constant value, the sparse engine
  /// is needed, values are random, or exponential diodes have a tangent at a current that depends on the run.
  [[nodiscard]] static std::optional<SteppedSources> make(circuit::Compiled compiled, std::size_t channels, EngineChoice choice);

  [[nodiscard]] const std::shared_ptr<const circuit::Compiled>& compiled() const { return compiled_; }
  /// Runs with `values` of the channels. The same values give the same rows, regardless of other runs; threads may call this at the same time.
  [[nodiscard]] Simulate simulate(std::span<const double> values) const;

 private:
  std::shared_ptr<const circuit::Compiled> compiled_;
  std::shared_ptr<const engine::ExactModel> model_;
};

}  // namespace pwlsim::analysis
