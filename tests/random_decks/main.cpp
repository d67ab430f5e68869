/// random_decks FIRST COUNT [spawn]: runs the decks of these seeds in this process, or each in one of its own; status 1 where one fails, with its smallest deck.
/// random_decks FIRST: writes that deck to standard output.

#include <fmt/format.h>

#include <cstdlib>
#include <map>
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

int examine(std::uint64_t first, std::uint64_t count, bool spawn) {
  const auto runner = spawn ? make_spawning_runner() : make_inner_runner();
  Examiner examiner(*runner);
  fmt::print("a deck that ends the process is left in {}\n", examiner.folder().path().string());
  std::map<int, int> statuses;
  int failures = 0;
  double longest = 0.0, largest = 0.0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
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
  return examine(first, std::strtoull(arguments[2], nullptr, 10), argument_count > 3 && std::string_view(arguments[3]) == "spawn");
}
