#include "random_decks/random_deck.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "random_decks/deck_cards.hpp"
#include "random_decks/deck_mistakes.hpp"

namespace pwlsim::test {
namespace {

class Maker {
 public:
  explicit Maker(std::uint64_t seed) : random_(seed), gate_random_(~seed) { deck_.lines.push_back(fmt::format("random deck {}", seed)); }

  RandomDeck run() {
    circuit();
    commands();
    deck_.lines.insert(deck_.lines.end(), scope_.lines.begin(), scope_.lines.end());
    if (gate_random_.chance(0.15)) gates();
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

  /// LTspice's A devices, each of which may drive others and a switch. Their numbers are apart, so that the decks without them are what they were.
  void gates() {
    struct Type {
      std::string name;
      std::vector<std::size_t> inputs;
    };
    static const std::vector<Type> types{{"BUF", {0}},       {"INV", {0}},        {"AND", {0, 1, 2, 3, 4}}, {"OR", {0, 1, 4}},
                                         {"XOR", {0, 1, 2}}, {"SCHMITT", {0, 1}}, {"SRFLOP", {0, 1}},       {"DFLOP", {0, 2, 3, 4}},
                                         {"DFLOP", {0, 2}}};
    std::vector<std::string> nodes = scope_.nodes;
    const auto number = [&](double low, double high) { return fmt::format("{:.3g}", gate_random_.between(low, high)); };
    for (int k = gate_random_.whole(1, 4); k > 0; --k) {
      const Type& type = gate_random_.one_of(types);
      const std::string common = gate_random_.chance(0.9) ? scope_.nodes.front() : gate_random_.one_of(scope_.nodes);
      std::vector<std::string> terminals(8, common);
      for (const std::size_t input : type.inputs)
        if (gate_random_.chance(0.85)) terminals[input] = gate_random_.one_of(nodes);
      for (const std::size_t out : {5U, 6U})
        if (gate_random_.chance(0.7)) nodes.push_back(terminals[out] = fmt::format("gate{}{}", k, out));
      std::string card = fmt::format("Agate{} {} {}", k, fmt::join(terminals, " "), type.name);
      if (gate_random_.chance(0.3)) card += " Vhigh=" + number(1.0, 10.0);
      if (gate_random_.chance(0.2)) card += " Vlow=" + number(-5.0, 1.0);
      if (gate_random_.chance(0.2)) card += " Ref=" + number(-1.0, 2.0);
      if (gate_random_.chance(0.2)) card += fmt::format(" Td={:.3g}", std::pow(10.0, gate_random_.between(-9.0, -3.0)));
      if (type.name == "SCHMITT" && gate_random_.chance(0.7)) card += fmt::format(" Vt={} Vh={}", number(-2.0, 2.0), number(0.0, 1.0));
      deck_.lines.push_back(std::move(card));
    }
    if (gate_random_.chance(0.5)) return;
    const std::string p = gate_random_.one_of(scope_.nodes), n = gate_random_.one_of(scope_.nodes), gate = gate_random_.one_of(nodes);
    deck_.lines.push_back(fmt::format("Sgate {} {} {} 0 mgate", p, n, gate));
    deck_.lines.push_back(fmt::format(".model mgate SW(Ron={} Vt=0.4 Vh={})", number(0.0, 10.0), number(0.0, 0.3)));
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

  Random random_, gate_random_;
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
