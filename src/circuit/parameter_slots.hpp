#pragma once
/// Where the values of one element stand in the network: what a change of one of them moves.

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "circuit/circuit.hpp"
#include "model/network.hpp"
#include "model/network_move.hpp"

namespace pwlsim::circuit {

/// The parts of the network that one element has become.
class ElementParts {
 public:
  explicit ElementParts(const elements::Instance& instance) : name_(instance.name) {}

  [[nodiscard]] std::string part(std::string_view suffix) const { return suffix.empty() ? name_ : fmt::format("{} ({})", name_, suffix); }

  template <class List>
  [[nodiscard]] int find(const List& list, std::string_view suffix) const {
    const std::string label = part(suffix);
    const auto found = std::find_if(list.begin(), list.end(), [&](const auto& item) { return item.label.name == label; });
    return found == list.end() ? -1 : static_cast<int>(found - list.begin());
  }
  /// Those of the element itself and of its parts.
  template <class List, class Take>
  void each(const List& list, const Take& take) const {
    const std::string prefix = name_ + " (";
    for (std::size_t k = 0; k < list.size(); ++k)
      if (const std::string& label = list[k].label.name; label == name_ || label.starts_with(prefix)) take(static_cast<int>(k));
  }

 private:
  std::string name_;
};

/// Adds what a change of one value of an element moves. False: that is not known.
class Slots {
 public:
  using NetworkMoves = model::NetworkMoves;

  Slots(const model::Network& network, const FlatCircuit& circuit, const elements::Instance& instance)
      : parts_(instance),
        network_(network),
        instance_(instance),
        model_(instance.model >= 0 ? &circuit.models[static_cast<std::size_t>(instance.model)] : nullptr) {}

  bool element_value(std::string_view name, double p, NetworkMoves& moves) const;
  bool model_value(std::string_view name, double p, NetworkMoves& moves) const;
  /// Whether the value of the model stands in the formula of its block, which moves by itself.
  [[nodiscard]] bool follows_block(std::string_view name) const;
  /// ": its tangents follow …", where the element has an exponential characteristic.
  [[nodiscard]] std::string tangent_note() const;
  bool waveform_value(std::string_view name, double p, NetworkMoves& moves) const;
  /// The value of a source without a waveform.
  bool constant_value(double p, NetworkMoves& moves) const;
  /// Its whole waveform, by the derivatives of all its numbers.
  bool source_moves(const model::SourceFunction& derivative, NetworkMoves& moves) const { return add_source(derivative, moves); }

  /// A gain, the only coefficient.
  bool gain(double p, NetworkMoves& moves) const;

 private:
  using Moved = model::NetworkMove::Item;

  [[nodiscard]] double value(std::string_view name) const { return instance_.values.get(name); }

  /// A number of the network that is proportional to a value of the card.
  template <class List, class Member>
  bool proportional(Moved item, const List& list, Member member, std::string_view part, double written, double p,
                    NetworkMoves& moves) const {
    const int k = parts_.find(list, part);
    if (k < 0 || written == 0.0) return false;
    moves.push_back({.item = item, .index = k, .derivative = p * list[static_cast<std::size_t>(k)].*member / written});
    return true;
  }

  bool resistor(std::string_view part, std::string_view name, double p, NetworkMoves& moves) const;
  bool inductor(std::string_view part, std::string_view name, double p, NetworkMoves& moves) const;
  bool capacitor(std::string_view part, std::string_view name, double p, NetworkMoves& moves) const;
  bool series_or_parallel(std::string_view name, double p, NetworkMoves& moves) const;
  /// So many in parallel.
  bool multiplicity(double p, NetworkMoves& moves) const;
  static bool initial(Moved item, int index, double p, NetworkMoves& moves);
  bool branch_resistance(double p, NetworkMoves& moves) const;
  bool contact(Moved item, int index, double p, NetworkMoves& moves) const;
  /// Of an exponential characteristic, whose current decides where it is taken.
  [[nodiscard]] bool is_tangent(int diode) const { return network_.diodes[static_cast<std::size_t>(diode)].law.has_value(); }

  bool leak(double p, NetworkMoves& moves) const;
  bool diode_value(std::string_view name, double p, NetworkMoves& moves) const;
  bool levels(double on, double off, NetworkMoves& moves) const;
  bool switch_value(std::string_view name, double p, NetworkMoves& moves) const;
  /// Its Ron and its threshold where it is a switch, and its body diodes.
  bool mosfet_value(std::string_view name, double p, NetworkMoves& moves) const;
  bool drop(int contact_index, double p, NetworkMoves& moves) const;
  bool add_source(const model::SourceFunction& derivative, NetworkMoves& moves) const;

  ElementParts parts_;
  const model::Network& network_;
  const elements::Instance& instance_;
  const elements::Model* model_;
};

}  // namespace pwlsim::circuit
