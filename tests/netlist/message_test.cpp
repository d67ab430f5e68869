#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>

#include "netlist/tree_text.hpp"

namespace {

std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  REQUIRE(file.good());
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

// Each pair of messages/ was checked by hand: the place, the text underlined, the words.
TEST_CASE("messages read as written down beside their decks", "[golden]") {
  const std::string name = GENERATE("expressions", "cards", "characters");
  const std::string base = PWLSIM_SOURCE_DIR "/tests/netlist/messages/" + name;
  CAPTURE(name);
  pwlsim::SourceStore sources;
  pwlsim::Diagnostics diagnostics;
  const auto deck = pwlsim::netlist::parse(name + ".input", read_text(base + ".input"), sources, diagnostics);
  std::string rendered;
  for (const auto& diagnostic : diagnostics.all()) {
    rendered += render(diagnostic, sources);
  }
  CHECK(rendered == read_text(base + ".expect"));
}
