#pragma once
/// Fills a Network item by item: nodes by name, every word of the vocabulary by its own `add`.

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "model/network.hpp"
#include "model/network_move.hpp"

namespace pwlsim::model {

[[nodiscard]] LinearForm voltage_between(NodeIndex p, NodeIndex n, double coefficient = 1.0);
[[nodiscard]] Term constant(double value);
/// sum += factor·form
void accumulate(LinearForm& sum, const LinearForm& form, double factor = 1.0);

/// Two complementarities, `first` and the next: 1 − u(first) is 1 for `argument` > 0, 0 for `argument` < 0, and any value between at 0.
/// If no loop leads from that value back to the argument, elements::decide_steps replaces them by switches, and `at_zero` is the value at 0.
struct Step {
  int first = 0;
  LinearForm argument;
  double at_zero = 0.0;
};

/// Names are compared without case; they are kept as first given. Every `add` returns the index of the item within its list.
class NetworkBuilder {
 public:
  /// The node of that name, created at its first use. "0" and "gnd" are ground.
  NodeIndex node(std::string_view name, SourceSpan where = {});
  [[nodiscard]] std::optional<NodeIndex> find_node(std::string_view name) const;
  /// A node inside an element: not found by name.
  NodeIndex inner_node(Label label);

  int add(Resistor item) { return append(network_.resistors, std::move(item)); }
  int add(Capacitor item) { return append(network_.capacitors, std::move(item)); }
  int add(Inductor item) { return append(network_.inductors, std::move(item)); }
  int add(Coupling item) { return append(network_.couplings, std::move(item)); }
  int add(Branch item) { return append(network_.branches, std::move(item)); }
  int add(Injection item) { return append(network_.injections, std::move(item)); }
  int add(Diode item) { return append(network_.diodes, std::move(item)); }
  int add(Complementarity item) { return append(network_.complementarities, std::move(item)); }
  int add(Step item) { return append(steps_, std::move(item)); }
  int add(Switch item) { return append(network_.switches, std::move(item)); }
  int add(Source item) { return append(network_.sources, std::move(item)); }
  int add(Signal item) { return append(network_.signals, std::move(item)); }
  int add(NodeCondition item) { return append(network_.node_conditions, std::move(item)); }
  int add(CurrentCondition item) { return append(network_.current_conditions, std::move(item)); }

  /// What a parameter of `.sens` moves.
  void move(std::size_t parameter, NetworkMove item) {
    if (moves_.size() <= parameter) moves_.resize(parameter + 1);
    moves_[parameter].push_back(std::move(item));
  }
  [[nodiscard]] std::vector<NetworkMoves>& moves() { return moves_; }

  /// Items whose forms need currents of elements added later are completed in place.
  [[nodiscard]] Network& network() { return network_; }
  [[nodiscard]] const Network& network() const { return network_; }
  /// The steps added since the last call.
  [[nodiscard]] std::vector<Step> take_steps() { return std::exchange(steps_, {}); }
  [[nodiscard]] Network take() { return std::move(network_); }

 private:
  template <class Item>
  static int append(std::vector<Item>& list, Item item) {
    list.push_back(std::move(item));
    return static_cast<int>(list.size()) - 1;
  }

  Network network_;
  std::vector<Step> steps_;
  std::vector<NetworkMoves> moves_;  ///< of each parameter
  std::unordered_map<std::string, NodeIndex> node_by_name_;
};

}  // namespace pwlsim::model
