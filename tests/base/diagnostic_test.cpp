#include "base/diagnostic.hpp"

#include <catch2/catch.hpp>

using pwlsim::Diagnostic;
using pwlsim::Diagnostics;
using pwlsim::nearest_name;
using pwlsim::Severity;
using pwlsim::SourceSpan;
using pwlsim::SourceStore;

namespace {

/// Renders an error on the first place where `meant` stands in `text`.
std::string rendered(const std::string& text, const std::string& meant) {
  SourceStore sources;
  const auto file = sources.add("a.net", text);
  const auto begin = static_cast<std::uint32_t>(text.find(meant));
  return render({Severity::error, "E-x", {file, begin, begin + static_cast<std::uint32_t>(meant.size())}, "no"}, sources);
}

std::size_t lines_in(const std::string& text) { return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')); }

}  // namespace

TEST_CASE("diagnostics are collected in order and errors are counted", "[unit]") {
  Diagnostics diagnostics;
  diagnostics.note("N-a", {}, "one");
  diagnostics.warning("W-b", {}, "two");
  CHECK_FALSE(diagnostics.has_errors());
  diagnostics.error("E-c", {}, "three");
  CHECK(diagnostics.has_errors());
  CHECK(diagnostics.error_count() == 1);
  REQUIRE(diagnostics.all().size() == 3);
  CHECK(diagnostics.all()[0].severity == Severity::note);
  CHECK(diagnostics.all()[1].id == "W-b");
  CHECK(diagnostics.all()[2].text == "three");
}

TEST_CASE("a message shows file, line, column, id, text, the line and a caret", "[unit]") {
  CHECK(rendered("title\nR1 a nide 10\n", "nide") ==
        "a.net:2:6: error[E-x]: no\n"
        "R1 a nide 10\n"
        "     ^~~~\n");
}

TEST_CASE("carets stand under the span", "[unit]") {
  struct Row {
    const char* text;
    const char* meant;
    const char* lines;
  };
  const auto row = GENERATE(Row{"R1 a b 10\r\n", "10", "R1 a b 10\n       ^~\n"}, Row{"R1 a", "1", "R1 a\n ^\n"},
                            Row{"C 1\u00B5 b", "b", "C 1\u00B5 b\n     ^\n"}, Row{"\tR1\ta b", "a b", "\tR1\ta b\n\t  \t^~~\n"},
                            Row{"R1 a\tb c", "a\tb", "R1 a\tb c\n   ^~~~~~\n"}, Row{"R1 a\n+ b", "a\n+ b", "R1 a\n   ^\n"},
                            Row{"R1 \x01 b", "b", "R1 \xEF\xBF\xBD b\n     ^\n"}, Row{"R1 \u202E b", "b", "R1 \xEF\xBF\xBD b\n     ^\n"});
  const std::string result = rendered(row.text, row.meant);
  CHECK(result.substr(result.find('\n') + 1) == row.lines);
}

TEST_CASE("an empty span and a span at the end of the line get one caret", "[unit]") {
  SourceStore sources;
  const auto file = sources.add("a.net", "R1 a\n");
  CHECK(render({Severity::warning, "W-x", {file, 4, 4}, "value"}, sources) == "a.net:1:5: warning[W-x]: value\nR1 a\n    ^\n");
  CHECK(render({Severity::note, "N-x", {file, 3, 3}, "value"}, sources) == "a.net:1:4: note[N-x]: value\nR1 a\n   ^\n");
}

TEST_CASE("a message without a place has one line", "[unit]") {
  CHECK(render({Severity::error, "E-x", {}, "no"}, SourceStore{}) == "error[E-x]: no\n");
}

TEST_CASE("overlong lines are shortened around the span", "[unit]") {
  const std::string text = std::string(10'000'000, 'a') + " here " + std::string(1000, 'b');
  const std::string result = rendered(text, "here");
  CHECK(result.size() < 600);
  CHECK(lines_in(result) == 3);
  CHECK(result.find("a.net:1:10000002: ") == 0);
  const auto source = result.find('\n') + 1;
  const auto carets = result.find('\n', source) + 1;
  // The line is cut on both sides; one column of it is the leading ellipsis of three bytes.
  CHECK(result.substr(source, 3) == "…");
  CHECK(result.substr(carets - 4, 3) == "…");
  CHECK(result.find("here", source) - source - 2 == result.find("^~~~", carets) - carets);
}

TEST_CASE("user text inside a message is made printable and bounded", "[unit]") {
  const std::string result = render({Severity::error, "E-x", {}, "a\nb" + std::string(5000, 'c')}, SourceStore{});
  CHECK(lines_in(result) == 1);
  CHECK(result.size() < 1100);
}

TEST_CASE("nearest_name finds a slip of the finger and nothing further off", "[unit]") {
  const std::vector<std::string> names{"out", "input", "switch_node", "gate", "Vcc"};
  struct Row {
    const char* name;
    const char* nearest;
  };
  const auto row = GENERATE(Row{"oout", "out"}, Row{"uot", "out"}, Row{"imput", "input"}, Row{"swich_nod", "switch_node"},
                            Row{"GATE", "gate"}, Row{"vcd", "Vcc"}, Row{"gxyz", ""}, Row{"q", ""}, Row{"", ""}, Row{"completely_else", ""});
  CAPTURE(row.name);
  CHECK(nearest_name(row.name, names) == row.nearest);
}

TEST_CASE("nearest_name prefers the nearest of several", "[unit]") {
  CHECK(nearest_name("output1", {"outpt2", "output2", "utput1"}) == "output2");
  CHECK(nearest_name("abc", {}).empty());
}
