#pragma once
/// Calls of subcircuits: each X card becomes the elements of its definition.

#include <string>
#include <unordered_map>

#include "circuit/bind.hpp"

namespace pwlsim::circuit {

class Expander {
 public:
  Expander(FlatCircuit& circuit, Binder& binder, Session& session) : circuit_(circuit), binder_(binder), session_(session) {}

  /// Binds every element card of the definition of `place`, calls included, and its .ic cards. The census must have passed.
  void expand(Place& place);

 private:
  bool counts(Place& place, const netlist::Card& card, std::unordered_map<std::string, const netlist::Card*>& counted);
  void call(Place& place, const netlist::Card& card);
  void unknown_call(Place& place, const netlist::Card& card, const netlist::Item* name);
  void enter(Place& place, const netlist::Card& card, const netlist::Item& name, const Definition& called);
  void note_gate_outputs(const Place& inner);
  void connect(Place& place, const netlist::Card& card, const netlist::Item& name, Place& inner);
  void connect_port(Place& inner, const netlist::Card& card, const netlist::Item& word, const std::string& port, model::NodeIndex node);
  [[nodiscard]] std::vector<const netlist::Item*> actual_nodes(const netlist::Card& card, const netlist::Item& name);
  void give_parameters(Place& place, const netlist::Card& card, const netlist::Item& name, Scope& inner);
  void give(Place& place, const netlist::Card& card, const netlist::Item& assignment, Scope& inner);
  void condition(Place& place, const netlist::Item& item);
  [[nodiscard]] std::string full_node_name(const Place& place, const std::string& name) const;
  [[nodiscard]] Reporter& reporter() { return session_.reporter; }

  FlatCircuit& circuit_;
  Binder& binder_;
  Session& session_;
};

}  // namespace pwlsim::circuit
