#pragma once
/// Runs that differ in the values of constant sources alone: the circuit is compiled and its model prepared once for all of them.

#include <memory>
#include <optional>
#include <span>

#include "analysis/prepared_engine.hpp"
#include "circuit/compile.hpp"
#include "engine/exact/exact.hpp"

namespace pwlsim::analysis {

class SteppedSources {
 public:
  /// `compiled` with `channels` sources held (CompileOptions::held). Empty where it cannot be: a channel has no source of constant value, the sparse engine
  /// is needed, values are random, or exponential diodes have a tangent at a current that depends on the run.
  [[nodiscard]] static std::optional<SteppedSources> make(circuit::Compiled compiled, std::size_t channels, EngineChoice choice);

  [[nodiscard]] const std::shared_ptr<const circuit::Compiled>& compiled() const { return compiled_; }
  /// `values` of the channels. The same values give the same rows, whatever else has been run; threads may ask side by side.
  [[nodiscard]] Simulate simulate(std::span<const double> values) const;

 private:
  std::shared_ptr<const circuit::Compiled> compiled_;
  std::shared_ptr<const engine::ExactModel> model_;
};

}  // namespace pwlsim::analysis
