/// Message pairs: tests/golden/NAME.net is compiled, its messages must read as NAME.expect.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include <catch2/catch.hpp>

#include "circuit/compile.hpp"
#include "netlist/load.hpp"

namespace fs = std::filesystem;
using namespace pwlsim;

namespace {

const fs::path root = PWLSIM_SOURCE_DIR;

std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<fs::path> files_with(const fs::path& folder, std::initializer_list<std::string> extensions) {
  std::vector<fs::path> list;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (std::find(extensions.begin(), extensions.end(), extension) != extensions.end()) list.push_back(entry.path());
  }
  std::sort(list.begin(), list.end());
  return list;
}

std::string messages_of(const fs::path& deck_file) {
  SourceStore sources;
  Diagnostics diagnostics;
  const netlist::Deck deck = netlist::parse(deck_file.filename().string(), read(deck_file), sources, diagnostics);
  const auto compiled = circuit::compile(deck, sources, diagnostics);
  CHECK(compiled.has_value() != diagnostics.has_errors());
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics.all()) text += render(diagnostic, sources) + "\n";
  return text;
}

std::set<std::string> ids_in(const std::string& text, const std::regex& pattern) {
  std::set<std::string> ids;
  for (std::sregex_iterator at(text.begin(), text.end(), pattern), end; at != end; ++at) ids.insert((*at)[1]);
  return ids;
}

}  // namespace

TEST_CASE("the messages of a deck are those expected of it", "[golden]") {
  const auto decks = files_with(root / "tests/golden", {".net"});
  REQUIRE(!decks.empty());
  for (const fs::path& deck : decks) {
    INFO(deck.filename().string());
    const fs::path expectation = fs::path(deck).replace_extension(".expect");
    REQUIRE(fs::exists(expectation));
    CHECK(messages_of(deck) == read(expectation));
  }
}

TEST_CASE("every message of the rooms circuit and elements stands in some message pair", "[golden]") {
  // Not reachable from a deck alone; flatten_test and assemble_test have them.
  const std::set<std::string> tested_elsewhere{"E-incomplete", "E-no-twin", "E-too-many-errors", "N-model-at-hand", "W-second-model"};
  std::set<std::string> used;
  for (const char* room : {"src/circuit", "src/elements"}) {
    for (const fs::path& file : files_with(root / room, {".cpp", ".hpp"}))
      used.merge(ids_in(read(file), std::regex("\"([EWN]-[a-z-]+)\"")));
  }
  std::set<std::string> expected;
  for (const fs::path& file : files_with(root / "tests/golden", {".expect"})) {
    expected.merge(ids_in(read(file), std::regex("(?:error|warning|note)\\[([EWN]-[a-z-]+)\\]")));
  }
  REQUIRE(used.size() > 50);
  for (const std::string& id : used) {
    INFO(id);
    CHECK(expected.contains(id) != tested_elsewhere.contains(id));
  }
}
