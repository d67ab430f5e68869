#pragma once
/// From a file's name to its compiled deck; reports all its mistakes.

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
  std::vector<std::string> files;             ///< all files read, the deck itself first
  std::optional<circuit::Compiled> compiled;  ///< empty if the deck has mistakes
  netlist::Drawing drawing;                   ///< empty if there is none
  std::vector<netlist::DrawnPlace> places;    ///< of the drawing
  circuit::DrawnNames drawn;                  ///< the names at these places
  Status status = Status::done;               ///< if it failed: wrong_input or file_error
  double seconds_parse = 0.0, seconds_flatten = 0.0;
};

/// `keep_drawing`: keeps the drawing of a schematic, for a picture with the signals of all nets and elements.
[[nodiscard]] DeckReading read_deck(const std::string& name, circuit::CompileOptions options, SourceStore& sources, Messages& messages,
                                    bool keep_drawing = false);

}  // namespace pwlsim::cli
