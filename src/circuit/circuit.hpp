#pragma once
/// A flat circuit: nodes, elements with the values of their parameters, models, saved signals and analyses. It does not depend on a
/// netlist, so that C++ programs can build one:
///
///     FlatCircuit circuit;
///     circuit.add("V1", {"in", "0"}).waveform = model::Dc{10.0};
///     circuit.add("R1", {"in", "out"}).values.set("R", 1e3);
///     circuit.add("D1", {"out", "0"}).model = circuit.add_model("D", "DI");
///
/// `assemble` turns it into the network of the model.

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "base/source.hpp"
#include "circuit/analyses.hpp"
#include "circuit/measurement.hpp"
#include "elements/kind.hpp"
#include "model/network.hpp"

namespace pwlsim::circuit {

/// One item of `.save`. Names may use ':' or '.' between instances and their contents.
struct SaveRequest {
  enum class Kind { all, voltage, current, raw };
  Kind kind = Kind::voltage;
  std::string column;  ///< as the output spells it
  std::string first;   ///< node or element
  std::string second;  ///< the second node of v(a,b), else ""
  SourceSpan first_span, second_span;
  char quantity = ' ';  ///< for a raw system: x, u or y
  int number = 0;       ///< and its number, from 1
};

/// Nodes and elements by full name whose signals a picture of the circuit shows. Unknown names, and elements without a current, are ignored.
struct DrawnNames {
  std::vector<std::string> nodes, elements;
};

/// One item of `.ic`: the voltage of a node or the current of an inductor, by full name.
struct InitialCondition {
  bool is_current = false;
  std::string name;
  double value = 0.0;
  SourceSpan span;
  std::vector<double> gradient{};  ///< to the parameters of .sens; empty where it does not depend on them
};

/// Elements of the deck that were converted to subcircuits.
struct HiddenParts {
  std::unordered_set<std::string> names;  ///< full, without case

  /// Whether the node or element of that full name is within one.
  [[nodiscard]] bool hold(std::string_view name) const;
};

/// A node that a gate holds at one of two voltages against ground.
struct GateOutput {
  model::NodeIndex node = model::ground;
  double low = 0.0, high = 0.0;
};

class FlatCircuit {
 public:
  std::string title;
  std::vector<elements::Instance> instances;
  std::vector<elements::Model> models;
  std::vector<SaveRequest> saves;  ///< none: all
  DrawnNames drawn;                ///< further signals of a picture
  HiddenParts hidden;
  std::unordered_set<model::NodeIndex> unread_nodes;  ///< of parts that were left out: no row shows them
  std::vector<GateOutput> gate_outputs;
  Measurements measurements, orbit_measurements;  ///< of .tran, of .pss
  std::vector<SaveRequest> probes;                ///< signals that measurements read
  std::size_t measured_signals = 0;               ///< the last signals of the network: drawn or measured, not saved; filled in by assemble
  std::size_t drawn_signals = 0;                  ///< the first of these, which are drawn
  std::vector<InitialCondition> conditions;
  Analyses analyses;
  std::vector<model::NetworkMoves>
      formula_moves;  ///< of an assembled circuit: what parameters of the deck move in formulas, by their numbers in gradients
  /// A source whose values a formula has taken as numbers: both as instances.
  struct Folded {
    int source = -1, reader = -1;
  };
  std::vector<Folded> folded;
  std::vector<elements::Written> unfollowed;  ///< numbers that depend on parameters of .sens but do not belong to an element
  std::vector<std::string> parameter_names;   ///< of the deck itself
  bool has_machines = false;                  ///< LTspice's .machine
  bool written_by_ltspice = false;            ///< by its own cards
  bool prints = false;                        ///< has a card `.print` or `.plot`
  std::string stands_for_ground;              ///< the node used as ground in a circuit without ground; else ""
  bool draws_random = false;                  ///< values differ from run to run of .step
  bool has_gaps = false;                      ///< some element could not be read: its connections are not known

  /// The node of that name, created at its first use; "0" and "gnd" are ground. Names are compared without case.
  model::NodeIndex node(std::string_view name, SourceSpan where = {});
  /// A new node, even if the name is taken; false then.
  bool add_node(std::string name, SourceSpan where, model::NodeIndex& index);
  [[nodiscard]] std::optional<model::NodeIndex> find_node(std::string_view name) const;
  [[nodiscard]] const std::vector<model::Label>& nodes() const { return nodes_; }

  /// An element of the kind of its first letter, which must be in the catalogue; its values, model, waveform, references and
  /// coefficients are filled in by the caller. The reference is valid until the next call.
  elements::Instance& add(std::string name, const std::vector<std::string>& node_names);
  /// Adds a model of a type that some element takes ("D", "SW", …); returns its index.
  int add_model(std::string_view type, std::string name);

 private:
  [[nodiscard]] bool is_ground(std::string_view name) const;

  std::vector<model::Label> nodes_;
  std::unordered_map<std::string, model::NodeIndex> node_by_name_;
};

/// The node to be used as ground if no element is connected to ground: the negative one of the first V, else the second of the first element. "" if
/// there is a ground, or no such node.
[[nodiscard]] std::string missing_ground(const FlatCircuit& circuit);

}  // namespace pwlsim::circuit
