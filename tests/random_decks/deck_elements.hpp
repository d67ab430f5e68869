#pragma once
/// Element cards of a random deck, with the models they name.

#include <string>
#include <string_view>
#include <utility>

#include "random_decks/deck_formulas.hpp"
#include "random_decks/deck_scope.hpp"
#include "random_decks/deck_values.hpp"

namespace pwlsim::test {

class DeckElements {
 public:
  DeckElements(Random& random, DeckValues& values, DeckFormulas& formulas) : random_(random), values_(values), formulas_(formulas) {}

  /// A card of that letter, one of R C L K V I E G F H B D S W A M J Q; X is a part of the shipped library.
  void add(DeckScope& scope, char letter);
  /// One of `letters`, of R C L D V, between two nodes, so that all hang together.
  void add_connection(DeckScope& scope, const std::string& from, const std::string& to, std::string_view letters = "RRRRRCCLDV");

  std::string waveform(const DeckScope& scope, bool current);

 private:
  std::string name(DeckScope& scope, char letter);
  std::pair<std::string, std::string> two_nodes(const DeckScope& scope);
  /// Of a voltage mostly a node of its own, so that sources seldom stand against one another.
  std::pair<std::string, std::string> output_nodes(DeckScope& scope, bool voltage);
  std::string element(const DeckScope& scope) { return random_.one_of(scope.measurable); }

  void two_terminal(DeckScope& scope, char letter, const std::string& nodes);
  void source(DeckScope& scope, char letter);
  void coupling(DeckScope& scope);
  void controlled(DeckScope& scope, char letter);
  void formula(DeckScope& scope);
  void diode(DeckScope& scope, const std::string& nodes);
  void controlled_switch(DeckScope& scope, char letter);
  void transistor(DeckScope& scope, char letter);
  void block(DeckScope& scope);
  void library_part(DeckScope& scope);

  /// One that stands already, or a new card.
  std::string model(DeckScope& scope, const std::string& type);
  std::string model_parameters(const DeckScope& scope, std::string_view type);
  std::string switch_parameters(const DeckScope& scope, std::string_view type);
  std::string block_parameters(std::string_view type);
  /// Those of ` a={0} b={1}…` separated by `|`, each with this chance.
  std::string some_of(std::string_view parameters, double chance);
  std::string pwl();

  Random& random_;
  DeckValues& values_;
  DeckFormulas& formulas_;
  int count_ = 0;
};

}  // namespace pwlsim::test
