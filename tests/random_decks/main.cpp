/// random_decks FIRST COUNT [spawn] [SEED…]: runs the decks of these seeds in this process, or each in one of its own; status 1 where one fails, with its
/// smallest deck. Further seeds are left out: those that are known to fail (docs/developer/open-ends.md).
/// random_decks FIRST: writes that deck to standard output.

#include <fmt/format.h>

#include <cstdlib>
#include <map>
#include <set>
#include <string_view>

#include "random_decks/deck_trial.hpp"

namespace {

using namespace pwlsim::test;

void print(const RandomDeck& deck) {
  const auto words = [](const std::vector<std::string>& list) {
    std::string text;
    for (const std::string& word : list) text += " " + word;
    return text;
  };
  fmt::print("* pwlsim{} DECK{}\n{}", words(deck.before), words(deck.after), deck.text());
  for (const auto& [name, text] : deck.files) fmt::print("--- {}\n{}", name, text);
}

int examine(std::uint64_t first, std::uint64_t count, bool spawn, const std::set<std::uint64_t>& known) {
  const auto runner = spawn ? make_spawning_runner() : make_inner_runner();
  Examiner examiner(*runner);
  fmt::print("a deck that ends the process is left in {}\n", examiner.folder().path().string());
  std::map<int, int> statuses;
  int failures = 0;
  double longest = 0.0, largest = 0.0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    if (known.count(seed) != 0) continue;
    const RandomDeck deck = make_random_deck(seed);
    const std::string fault = examiner.examine(deck, std::to_string(seed));
    ++statuses[examiner.last().status];
    longest = std::max(longest, examiner.last().seconds);
    largest = std::max(largest, examiner.last().resident_mebibytes);
    if (fault.empty()) continue;
    fmt::print("\n{}: {}\n", seed, fault);
    if (++failures <= 20) print(smallest(deck, examiner, fault));
    std::fflush(stdout);
  }
  fmt::print("{} decks, {} failures; longest {:.2f} s, largest {:.0f} MiB\n", count, failures, longest, largest);
  for (const auto& [status, number] : statuses) fmt::print("status {}: {}\n", status, number);
  for (const std::string& name : examiner.long_runs()) fmt::print("more events than there is time for: {}\n", name);
  fmt::print("messages, and the first deck with each:\n");
  for (const auto& [id, name] : examiner.first_with()) fmt::print("  {} {}\n", id, name);
  return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count < 2) return EXIT_FAILURE;
  const std::uint64_t first = std::strtoull(arguments[1], nullptr, 10);
  if (argument_count == 2) {
    print(make_random_deck(first));
    return EXIT_SUCCESS;
  }
  const bool spawn = argument_count > 3 && std::string_view(arguments[3]) == "spawn";
  std::set<std::uint64_t> known;
  for (int i = spawn ? 4 : 3; i < argument_count; ++i) known.insert(std::strtoull(arguments[i], nullptr, 10));
  return examine(first, std::strtoull(arguments[2], nullptr, 10), spawn, known);
}
