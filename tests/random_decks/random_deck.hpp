#pragma once
/// Random decks over the whole language, most of them well formed, some with mistakes in them; short to run.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace pwlsim::test {

struct RandomDeck {
  std::vector<std::string> lines;            ///< the title is the first
  std::map<std::string, std::string> files;  ///< beside it: what it includes, raw systems
  std::vector<std::string> before, after;    ///< words of the command line around the deck's name

  [[nodiscard]] std::string text() const;
};

/// The same for the same seed and compiler (arguments are evaluated in no fixed order).
[[nodiscard]] RandomDeck make_random_deck(std::uint64_t seed);

}  // namespace pwlsim::test
