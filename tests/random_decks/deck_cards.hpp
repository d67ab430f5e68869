#pragma once
/// Dot cards of a random deck: analyses, signals, measurements, sweeps, options, definitions.

#include <map>
#include <string>

#include "random_decks/deck_elements.hpp"

namespace pwlsim::test {

class DeckCards {
 public:
  DeckCards(Random& random, DeckValues& values, DeckFormulas& formulas, DeckElements& elements)
      : random_(random), values_(values), formulas_(formulas), elements_(elements) {}

  void parameters(DeckScope& scope);
  /// A definition with everything that belongs to it, and its call.
  void subcircuit(DeckScope& scope, int depth);
  void analyses(DeckScope& scope);
  void signals(DeckScope& scope);
  void conditions(DeckScope& scope);
  void measurements(DeckScope& scope);
  void sweep(DeckScope& scope);
  void options(DeckScope& scope);
  /// What other simulators have.
  void oddities(DeckScope& scope);
  void raw_system(DeckScope& scope, std::map<std::string, std::string>& files);
  /// Moves some of its lines into a file.
  void include(DeckScope& scope, std::map<std::string, std::string>& files);

  /// Elements that connect the nodes, and as many more.
  void circuit(DeckScope& scope, int more);

 private:
  std::string measurement(const DeckScope& scope);
  std::string window();
  std::string passage(const DeckScope& scope);

  Random& random_;
  DeckValues& values_;
  DeckFormulas& formulas_;
  DeckElements& elements_;
  int count_ = 0;
};

}  // namespace pwlsim::test
