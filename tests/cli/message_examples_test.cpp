// An example of each message that no pair of tests/golden shows: tests/messages/ID.net is run as its comment says, and must say ID.expect;
// where that begins with a line of "…", it must end so.

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <regex>
#include <sstream>

#include "cli/run_in.hpp"

namespace fs = std::filesystem;
using namespace pwlsim::test;

namespace {

const fs::path folder = fs::path(PWLSIM_SOURCE_DIR) / "tests/messages";

std::vector<std::string> example_ids() {
  std::vector<std::string> ids;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".net") ids.push_back(entry.path().stem().string());
  std::sort(ids.begin(), ids.end());
  return ids;
}

/// The words behind "* pwlsim" in the deck; a deck without a line of its own is run as it is.
std::vector<std::string> arguments_of(const std::string& deck, const std::string& id) {
  static const std::regex call("(^|\n)\\* pwlsim(.*)");
  std::smatch match;
  if (!std::regex_search(deck, match, call)) return {id + ".net"};
  std::istringstream words(match[2]);
  return {std::istream_iterator<std::string>(words), {}};
}

/// The messages alone; numbers that are computed may differ in their last places from one machine to another.
std::string comparable(const std::string& text) {
  std::string messages;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with("wrote ") && !line.starts_with("orbit of ") && !line.starts_with("ac response ")) messages += line + '\n';
  return std::regex_replace(messages, std::regex("[0-9]+\\.[0-9]+(e-?[0-9]+)?|[0-9]e-[0-9]+"), "#");
}

bool is_expected(const std::string& text, const std::string& expectation) {
  static const std::string cut = "…\n";
  return expectation.starts_with(cut) ? text.ends_with(expectation.substr(cut.size())) : text == expectation;
}

}  // namespace

TEST_CASE("each example gives its message to the letter", "[golden]") {
  const std::vector<std::string> ids = example_ids();
  REQUIRE(ids.size() > 30);
  for (const std::string& id : ids) {
    INFO(id);
    const Scratch scratch;
    for (const auto& entry : fs::directory_iterator(folder)) fs::copy(entry.path(), scratch.path());
    const Finished finished = run_in(scratch, arguments_of(read_file(folder / (id + ".net")), id));
    CHECK(finished.err.find('[' + id + ']') != std::string::npos);
    const std::string said = comparable(finished.err), expected = comparable(read_file(folder / (id + ".expect")));
    INFO(said << "\ninstead of\n" << expected);
    CHECK(is_expected(said, expected));
  }
}
