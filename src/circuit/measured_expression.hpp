#pragma once
/// Expressions of .meas cards -> MeasuredExpression. Parameters are evaluated, .func functions written out; V(…) and I(…) become probes.

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "circuit/circuit.hpp"
#include "circuit/scope.hpp"

namespace pwlsim::circuit {

class MeasuredExpressionReader {
 public:
  /// `results`: numbers of the measurements by name without case. New probes are added to `circuit`.
  MeasuredExpressionReader(Scope& scope, Reporter& reporter, const std::unordered_map<std::string, int>& results, FlatCircuit& circuit)
      : scope_(scope), reporter_(reporter), results_(results), circuit_(circuit) {}

  /// Empty after an error.
  [[nodiscard]] std::optional<MeasuredExpression> read(const netlist::Item& item);

 private:
  using Expression = netlist::Expression;
  using Steps = std::vector<MeasuredExpression::Step>;
  using Step = MeasuredExpression::Step;
  using Arguments = std::unordered_map<std::string, Steps>;

  bool add(const Expression& expression, Scope& scope, const Arguments* arguments, int depth, Steps& steps);
  bool add_name(const Expression& expression, Scope& scope, const Arguments* arguments, Steps& steps);
  bool add_call(const Expression& expression, Scope& scope, const Arguments* arguments, int depth, Steps& steps);
  bool add_function(const Expression& expression, const FunctionText& function, Scope& home, Scope& scope, const Arguments* arguments,
                    int depth, Steps& steps);
  bool add_builtin(const Expression& expression, Scope& scope, const Arguments* arguments, int depth, Steps& steps);
  bool add_signal(const Expression& expression, Steps& steps);
  bool add_number(const Expression& expression, Scope& scope, Steps& steps);
  bool count_is(const Expression& expression, std::size_t least, std::size_t most);
  bool fail(std::string id, const Expression& expression, std::string text);

  Scope& scope_;
  Reporter& reporter_;
  const std::unordered_map<std::string, int>& results_;
  FlatCircuit& circuit_;
};

/// The probe of a signal, added if it is new.
[[nodiscard]] int add_probe(FlatCircuit& circuit, SaveRequest request);

}  // namespace pwlsim::circuit
