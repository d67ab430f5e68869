#pragma once
/// The context that the readers of element cards share: the place of a card, nodes, models, messages.

#include <string>
#include <unordered_map>

#include "circuit/circuit.hpp"
#include "circuit/models.hpp"
#include "circuit/scope.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

/// The place where cards are bound: the deck, or one call of a subcircuit.
struct Place {
  Scope& scope;
  std::string prefix;                                       ///< of names: "" or "X1.X2."
  std::unordered_map<std::string, model::NodeIndex> nodes;  ///< local ones by key, ports included; unused in the deck itself
  bool is_made = false;                                     ///< not text of the deck: its names are not global
};

class Binding {
 public:
  Binding(FlatCircuit& circuit, const Definitions& definitions, Models& models, Reporter& reporter)
      : circuit_(circuit), definitions_(definitions), models_(models), reporter_(reporter) {}

  /// The node that a word names at `place`, created at its first use.
  [[nodiscard]] model::NodeIndex node(Place& place, const netlist::Item& word);
  /// Whether the node is the same everywhere: by `.global`, or by a name of LTspice and PSpice: `$G_VDD`.
  [[nodiscard]] bool is_global(const std::string& key) const { return key.starts_with("$g_") || definitions_.global_nodes.contains(key); }
  /// Notes a source with a DC value and a waveform: other simulators take the DC value for .op.
  void note_two_values(const netlist::Card& card);
  /// A card is incomplete: its connections are not known.
  void leave_gap() { circuit_.has_gaps = true; }
  [[nodiscard]] FlatCircuit& circuit() { return circuit_; }
  [[nodiscard]] Reporter& reporter() { return reporter_; }
  [[nodiscard]] Models& models() { return models_; }

 private:
  FlatCircuit& circuit_;
  const Definitions& definitions_;
  Models& models_;
  Reporter& reporter_;
};

}  // namespace pwlsim::circuit
