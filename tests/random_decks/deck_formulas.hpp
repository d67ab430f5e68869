#pragma once
/// Expressions of a random deck: of parameters, of signals (B sources), of signals that are measured.

#include <string>

#include "random_decks/deck_scope.hpp"
#include "random_decks/deck_values.hpp"

namespace pwlsim::test {

class DeckFormulas {
 public:
  DeckFormulas(Random& random, DeckValues& values) : random_(random), values_(values) {}

  /// A number near one.
  std::string of_parameters(const DeckScope& scope, int depth);
  /// Piecewise linear but for a few.
  std::string of_signals(const DeckScope& scope, int depth);
  /// Products, quotients and functions as well.
  std::string measured(const DeckScope& scope, int depth);

  std::string signal(const DeckScope& scope);
  std::string node(const DeckScope& scope) { return random_.one_of(scope.nodes); }

 private:
  std::string table(const DeckScope& scope, int depth);
  std::string condition(const DeckScope& scope, int depth);
  std::string of_time();

  Random& random_;
  DeckValues& values_;
};

}  // namespace pwlsim::test
