#pragma once
/// Reading a deck: text decoding, logical lines, X3 grammar, includes and library sections in place.

#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.hpp"
#include "base/source.hpp"
#include "netlist/ast.hpp"
#include "netlist/schematic/drawing.hpp"

namespace pwlsim::netlist {

/// `.options max_include_depth=` (to 1000) and `max_parentheses=` (to 1e6) raise them for the following lines of the deck.
struct LoadLimits {
  int include_depth = 100;
  int parentheses = 1000;  ///< in an expression; groups outside of expressions nest to 50
};

/// `.asc`: a schematic of LTspice, which is read as the netlist that LTspice makes of it.
[[nodiscard]] bool is_schematic(std::string_view path);

/// Reads `path` and all files that it includes. Syntax errors of all files go to `diagnostics`; the readable parts are returned anyway.
/// `readable` is false if the top file itself cannot be read (exit status 3).
struct Loaded {
  Deck deck;
  bool readable = true;
  std::vector<std::string> files;  ///< those read: the top file, then the others
};
/// `drawing` receives the data for a picture of a schematic; null: not wanted.
[[nodiscard]] Loaded load(const std::string& path, SourceStore& sources, Diagnostics& diagnostics, const LoadLimits& limits = {},
                          Drawing* drawing = nullptr);

/// The netlist of the schematic `path` as text.
struct WrittenNetlist {
  std::string text;
  bool readable = true;            ///< the schematic itself
  std::vector<std::string> files;  ///< those read: the schematic, then the others
};
[[nodiscard]] WrittenNetlist write_netlist(const std::string& path, SourceStore& sources, Diagnostics& diagnostics);

/// The same from text in memory; messages use `name`, and includes are looked up from the current directory.
[[nodiscard]] Deck parse(const std::string& name, std::string_view text, SourceStore& sources, Diagnostics& diagnostics,
                         const LoadLimits& limits = {});

}  // namespace pwlsim::netlist
