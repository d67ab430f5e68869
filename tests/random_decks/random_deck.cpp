#include "random_decks/random_deck.hpp"

#include <fmt/format.h>

#include <array>

#include "random_decks/deck_cards.hpp"
#include "random_decks/deck_mistakes.hpp"

namespace pwlsim::test {
namespace {

class Maker {
 public:
  explicit Maker(std::uint64_t seed) : random_(seed) { deck_.lines.push_back(fmt::format("random deck {}", seed)); }

  RandomDeck run() {
    circuit();
    commands();
    deck_.lines.insert(deck_.lines.end(), scope_.lines.begin(), scope_.lines.end());
    deck_.lines.emplace_back(".end");
    if (random_.chance(0.2))
      for (int count = random_.whole(1, 3); count > 0; --count) make_mistake(deck_.lines, random_);
    if (random_.chance(0.5)) write_otherwise(deck_.lines, random_);
    command_line();
    return std::move(deck_);
  }

 private:
  void circuit() {
    static const std::vector<std::string> names{"a", "b", "out", "in", "n1", "3", "net-x", "Vcc", "x_y"};
    scope_.nodes = {random_.chance(0.95) ? "0" : "gnd"};
    const int nodes = random_.whole(1, 6);
    for (int i = 0; i < nodes; ++i) scope_.nodes.push_back(names[static_cast<std::size_t>(i)]);
    if (random_.chance(0.5)) cards_.parameters(scope_);
    elements_.add(scope_, random_.chance(0.9) ? 'V' : 'I');
    cards_.circuit(scope_, random_.whole(0, 10));
    if (random_.chance(0.25)) cards_.subcircuit(scope_, 2);
    if (random_.chance(0.04)) cards_.raw_system(scope_, deck_.files);
  }

  void commands() {
    cards_.analyses(scope_);
    cards_.signals(scope_);
    cards_.conditions(scope_);
    cards_.measurements(scope_);
    cards_.sweep(scope_);
    cards_.options(scope_);
    cards_.oddities(scope_);
    if (random_.chance(0.05)) cards_.include(scope_, deck_.files);
  }

  void command_line() {
    static const std::vector<std::vector<std::string>> runs{{"--events"},
                                                            {"--engine", "sparse"},
                                                            {"--engine", "sparse", "--reltol", "1e-6"},
                                                            {"--engine", "exact"},
                                                            {"--format", "raw"},
                                                            {"--stats", "stats.json"},
                                                            {"--plot", "plot.svg"},
                                                            {"--report", "report.html"},
                                                            {"--json"},
                                                            {"-o", "-"},
                                                            {"-o", "other.csv", "--quiet"},
                                                            {"--verbose", "--events"},
                                                            {"--reltol", "0"}};
    if (random_.chance(0.5)) return;
    if (random_.chance(0.7)) {
      deck_.after = random_.one_of(runs);
    } else if (random_.chance(0.6)) {
      deck_.before = {"inspect"};
      if (random_.chance(0.5)) deck_.after = {"--json"};
    } else {
      deck_.before = {"export"};
      deck_.after = {"-o", random_.chance(0.5) ? "twin.cir" : "-"};
    }
  }

  Random random_;
  DeckValues values_{random_};
  DeckFormulas formulas_{random_, values_};
  DeckElements elements_{random_, values_, formulas_};
  DeckCards cards_{random_, values_, formulas_, elements_};
  DeckScope scope_;
  RandomDeck deck_;
};

}  // namespace

std::string RandomDeck::text() const {
  std::string result;
  for (const std::string& line : lines) result += line + "\n";
  return result;
}

RandomDeck make_random_deck(std::uint64_t seed) { return Maker(seed).run(); }

}  // namespace pwlsim::test
