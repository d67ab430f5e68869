#include "netlist/schematic/shelf.hpp"

#include "netlist/decode.hpp"
#include "netlist/files.hpp"

namespace pwlsim::netlist {

std::filesystem::path Shelf::find(const std::string& name, const std::filesystem::path& folder) const {
  std::filesystem::path path = find_file(name, folder).path;
  if (path.empty() && folder != root_) path = find_file(name, root_).path;
  return path;
}

FoundSymbol Shelf::standard(const std::string& name) {
  if (const Symbol* known = find_standard_symbol(name)) return {known, {}};
  std::optional<Symbol> guess = guess_amplifier(name);
  if (!guess) return {};
  return {&guessed_.try_emplace(name, std::move(*guess)).first->second, {}, true};
}

FoundSymbol Shelf::symbol(const std::string& name, const std::filesystem::path& folder) {
  const std::filesystem::path path = find(name + ".asy", folder);
  if (path.empty()) return standard(name);
  auto known = read_.find(path);
  if (known == read_.end()) {
    FileBytes file = read_file(path);
    if (!file.readable) return standard(name);
    const DecodedText decoded = decode(std::move(file.bytes));
    known = read_.emplace(path, read_symbol(std::string(without_folder(name)), decoded.text)).first;
  }
  return {&known->second, path};
}

std::filesystem::path Shelf::block(const FoundSymbol& found, const std::string& name, const std::filesystem::path& folder) const {
  const std::filesystem::path own = find_file(std::string(without_folder(name)) + ".asc", found.file.parent_path()).path;
  return own.empty() ? find(name + ".asc", folder) : own;
}

std::vector<std::string> Shelf::files() const {
  std::vector<std::string> names;
  for (const auto& [path, symbol] : read_) names.push_back(path.string());
  return names;
}

}  // namespace pwlsim::netlist
