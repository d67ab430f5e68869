#include "netlist/load.hpp"

#include <filesystem>
#include <utility>

#include "base/names.hpp"
#include "netlist/files.hpp"
#include "netlist/loader.hpp"

namespace pwlsim::netlist {

bool is_schematic(std::string_view path) {
  constexpr std::string_view ending = ".asc";
  return path.size() > ending.size() && same_name(path.substr(path.size() - ending.size()), ending);
}

WrittenNetlist write_netlist(const std::string& path, SourceStore& sources, Diagnostics& diagnostics) {
  FileBytes file = read_file(path);
  if (!file.readable) {
    diagnostics.error("E-file-unreadable", {}, "cannot read '" + path + "': " + file.reason);
    return {{}, false, {}};
  }
  Loader loader(sources, diagnostics, {});
  WrittenNetlist written{loader.write_netlist(path, std::move(file.bytes), std::filesystem::path(path).parent_path()), true, {path}};
  for (std::string& name : loader.files()) written.files.push_back(std::move(name));
  return written;
}

Loaded load(const std::string& path, SourceStore& sources, Diagnostics& diagnostics, const LoadLimits& limits, Drawing* drawing) {
  FileBytes file = read_file(path);
  if (!file.readable) {
    diagnostics.error("E-file-unreadable", {}, "cannot read '" + path + "': " + file.reason);
    return {{}, false, {}};
  }
  Loader loader(sources, diagnostics, limits);
  loader.keep_drawing(drawing);
  Loaded loaded{loader.read_deck(path, std::move(file.bytes), std::filesystem::path(path).parent_path()), true, {path}};
  for (std::string& name : loader.files()) loaded.files.push_back(std::move(name));
  return loaded;
}

Deck parse(const std::string& name, std::string_view text, SourceStore& sources, Diagnostics& diagnostics, const LoadLimits& limits) {
  Loader loader(sources, diagnostics, limits);
  return loader.read_deck(name, std::string(text), {});
}

}  // namespace pwlsim::netlist
