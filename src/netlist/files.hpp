#pragma once
/// Files named in a deck.

#include <filesystem>
#include <string>
#include <string_view>

namespace pwlsim::netlist {

/// The bytes of a file, or why there are none.
struct FileBytes {
  bool readable = false;
  std::string bytes;
  std::string reason;  ///< of the operating system, where not readable
};
[[nodiscard]] FileBytes read_file(const std::filesystem::path& path);

struct FoundFile {
  std::filesystem::path path;  ///< empty where there is none
  std::string reason;          ///< then: "no such file …", "it is a directory …"
  bool is_elsewhere = false;   ///< not where the name says, but beside the file that names it
};
/// Where `name`, written in a file of `directory`, is found: beside that file, then in the current directory; backslashes may part
/// the folders. Only regular files count. Where there is none, letter case does not count, and then not the folder of `name` either.
[[nodiscard]] FoundFile find_file(std::string_view name, const std::filesystem::path& directory);

/// `C:\…`, or any name with a backslash.
[[nodiscard]] bool is_windows_path(std::string_view name);
/// Whether the ending is that of files that hold models and subcircuits.
[[nodiscard]] bool names_models(std::string_view name);

/// LTspice's own `standard.dio`, `standard.mos`, `opamp.sub` and so on, PSpice's `nom.lib` and `eval.lib`, in whatever folder.
[[nodiscard]] bool is_standard_library(std::string_view name);

}  // namespace pwlsim::netlist
