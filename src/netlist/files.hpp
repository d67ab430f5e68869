#pragma once
/// Files named in a deck.

#include <filesystem>
#include <string>
#include <string_view>

namespace pwlsim::netlist {

/// The bytes of a file, or the reason why it cannot be read.
struct FileBytes {
  bool readable = false;
  std::string bytes;
  std::string reason;  ///< of the operating system, if not readable
};
[[nodiscard]] FileBytes read_file(const std::filesystem::path& path);

struct FoundFile {
  std::filesystem::path path;  ///< empty if not found
  std::string reason;          ///< if not found: "no such file …", "it is a directory …"
  bool is_elsewhere = false;   ///< not at the given path, but beside the file that names it
};
/// Finds `name`, written in a file of `directory`: beside that file, then in the current directory; backslashes may separate
/// folders. Only regular files count. If there is none, the search ignores letter case, and then the folder of `name`, too.
[[nodiscard]] FoundFile find_file(std::string_view name, const std::filesystem::path& directory);

/// `C:\…`, or any name with a backslash.
[[nodiscard]] bool is_windows_path(std::string_view name);
/// Whether the file ending is that of models and subcircuits.
[[nodiscard]] bool names_models(std::string_view name);

/// LTspice's own `standard.dio`, `standard.mos`, `opamp.sub` and so on, PSpice's `nom.lib` and `eval.lib`, in any folder.
[[nodiscard]] bool is_standard_library(std::string_view name);

}  // namespace pwlsim::netlist
