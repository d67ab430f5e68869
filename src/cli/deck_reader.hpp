#pragma once
/// From a file's name to its compiled deck, with everything said that is wrong with it.

#include <optional>
#include <string>
#include <vector>

#include "circuit/compile.hpp"
#include "cli/messages.hpp"
#include "cli/status.hpp"

namespace pwlsim::cli {

struct DeckReading {
  netlist::Deck deck;
  std::vector<std::string> files;             ///< that were read, the deck's own first
  std::optional<circuit::Compiled> compiled;  ///< empty where the deck is wrong
  Status status = Status::done;               ///< wrong_input or file_error then
  double seconds_parse = 0.0, seconds_flatten = 0.0;
};

[[nodiscard]] DeckReading read_deck(const std::string& name, const circuit::CompileOptions& options, SourceStore& sources,
                                    Messages& messages);

}  // namespace pwlsim::cli
