#pragma once
/// Finds the symbols and blocks beside a schematic.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "netlist/schematic/sheet.hpp"

namespace pwlsim::netlist {

/// A symbol that a schematic names, and its file.
struct FoundSymbol {
  const Symbol* symbol = nullptr;  ///< null if not found
  std::filesystem::path file;      ///< empty for one of LTspice's library
  bool is_guess = false;           ///< an amplifier that is assumed to have five pins
};

/// Reads each file once.
class Shelf {
 public:
  /// `root` is the folder of the top schematic.
  explicit Shelf(std::filesystem::path root) : root_(std::move(root)) {}

  /// NAME.asy beside the schematic of `folder`, or of the root, else LTspice's own.
  [[nodiscard]] FoundSymbol symbol(const std::string& name, const std::filesystem::path& folder);
  /// The schematic NAME.asc beside the symbol's file, or in those folders; empty if there is none.
  [[nodiscard]] std::filesystem::path block(const FoundSymbol& found, const std::string& name, const std::filesystem::path& folder) const;

  /// The files read.
  [[nodiscard]] std::vector<std::string> files() const;

 private:
  [[nodiscard]] FoundSymbol standard(const std::string& name);
  [[nodiscard]] std::filesystem::path find(const std::string& name, const std::filesystem::path& folder) const;

  std::filesystem::path root_;
  std::map<std::filesystem::path, Symbol> read_;
  std::map<std::string, Symbol> guessed_;
};

}  // namespace pwlsim::netlist
