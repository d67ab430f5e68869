#pragma once
/// Runs that differ in the values of constant sources alone: the circuit is compiled and its model prepared once for all of them.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/prepared_engine.hpp"
#include "circuit/compile.hpp"
#include "engine/exact/exact.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::analysis {

class SteppedSources {
 public:
  /// Empty where it cannot be: one of the names is no source of constant value (or something folds it into another part), the sparse engine is needed, or
  /// exponential diodes have a tangent at a current that depends on the run. `options`: of the compilation, but for `held`.
  [[nodiscard]] static std::optional<SteppedSources> make(const netlist::Deck& deck, SourceStore sources, circuit::CompileOptions options,
                                                          const std::vector<std::string>& names, EngineChoice choice, double reltol);

  [[nodiscard]] const std::shared_ptr<const circuit::Compiled>& compiled() const { return compiled_; }
  /// `values` of the names. The same values give the same rows, whatever else has been run; threads may ask side by side.
  [[nodiscard]] Simulate simulate(std::span<const double> values) const;

 private:
  std::shared_ptr<const circuit::Compiled> compiled_;
  std::shared_ptr<const engine::ExactModel> model_;
};

}  // namespace pwlsim::analysis
