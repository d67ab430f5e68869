#pragma once
/// From a file's name to its compiled deck, with everything said that is wrong with it.

#include <optional>
#include <string>
#include <vector>

#include "circuit/compile.hpp"
#include "cli/messages.hpp"
#include "cli/status.hpp"
#include "netlist/schematic/drawing.hpp"

namespace pwlsim::cli {

struct DeckReading {
  netlist::Deck deck;
  std::vector<std::string> files;             ///< that were read, the deck's own first
  std::optional<circuit::Compiled> compiled;  ///< empty where the deck is wrong
  netlist::Drawing drawing;                   ///< empty where there is none
  std::vector<netlist::DrawnPlace> places;    ///< of the drawing
  Status status = Status::done;               ///< wrong_input or file_error then
  double seconds_parse = 0.0, seconds_flatten = 0.0;
};

/// `keep_drawing`: of a schematic, for a picture that shows the signals of all its nets and elements.
[[nodiscard]] DeckReading read_deck(const std::string& name, circuit::CompileOptions options, SourceStore& sources, Messages& messages,
                                    bool keep_drawing = false);

}  // namespace pwlsim::cli
