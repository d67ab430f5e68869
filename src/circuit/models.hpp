#pragma once
/// `.model` cards: found from where they are used, evaluated once in each scope that defines them.

#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "circuit/circuit.hpp"
#include "circuit/devices.hpp"
#include "circuit/scope.hpp"
#include "elements/kind.hpp"

namespace pwlsim::circuit {

class Models {
 public:
  /// `devices`: models at hand; a note reports each one that is used.
  Models(FlatCircuit& circuit, const elements::Settings& settings, Reporter& reporter, const DeviceSources* devices = nullptr)
      : circuit_(circuit), settings_(settings), reporter_(reporter), devices_(devices) {}

  /// The index in circuit.models of the model `name` as seen from `scope`, for an element of `kind`; -1 after an error.
  [[nodiscard]] int use(Scope& scope, const netlist::Item& name, const elements::Kind& kind);

  [[nodiscard]] const elements::Model& at(int index) const { return circuit_.models[static_cast<std::size_t>(index)]; }
  [[nodiscard]] static bool known(Scope& scope, const netlist::Item& name);
  /// The type of the model `name`; null if there is none, or its card cannot be read.
  [[nodiscard]] const elements::ModelKind* kind_of(Scope& scope, const netlist::Item& name);

  /// Reports errors in models of `file` that nothing used: a mistake counts even without effect.
  void check_unused(Scope& top, FileIndex file);

 private:
  [[nodiscard]] int evaluated(Scope& scope, const netlist::Card& card);
  [[nodiscard]] std::optional<elements::Model> read(Scope& scope, const netlist::Card& card);
  [[nodiscard]] const elements::ModelKind* kind_of(Scope& scope, const netlist::Card& card);
  [[nodiscard]] bool is_idealised(Scope& scope, const netlist::Card& card);
  void tell_device(const netlist::Card& card, const netlist::Item& name);
  void report_unknown(Scope& scope, const netlist::Item& name, const elements::Kind& kind);

  FlatCircuit& circuit_;
  const elements::Settings& settings_;
  Reporter& reporter_;
  const DeviceSources* devices_;
  std::unordered_set<const netlist::Card*> used_;
};

/// The parts of a model card: `.model name [ako:base] TYPE(p=value …)`, the parentheses optional.
struct ModelText {
  std::string_view type;  ///< "" if the base gives it
  SourceSpan type_span;
  const netlist::Item* base = nullptr;
  std::string base_name;
  std::vector<const netlist::Item*> parameters;
};
[[nodiscard]] std::optional<ModelText> read_model_text(const netlist::Card& card, Reporter& reporter);

}  // namespace pwlsim::circuit
