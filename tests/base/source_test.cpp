#include "base/source.hpp"

#include <catch2/catch.hpp>

using pwlsim::cover;
using pwlsim::SourceSpan;
using pwlsim::SourceStore;

TEST_CASE("positions count lines from 1 and columns in code points", "[unit]") {
  SourceStore sources;
  // Blank lines, CRLF, a two-byte µ, no line end at the end of the text.
  const std::string text = "title\n\n\r\nC1 a 0 1\u00B5F x\nlast";
  const auto file = sources.add("a.net", text);
  struct Row {
    const char* at;
    std::uint32_t line;
    std::uint32_t column;
  };
  const auto row = GENERATE(Row{"title", 1, 1}, Row{"itle", 1, 2}, Row{"C1", 4, 1}, Row{"F x", 4, 10}, Row{"x\n", 4, 12}, Row{"last", 5, 1},
                            Row{"st", 5, 3});
  const auto position = sources.position(file, static_cast<std::uint32_t>(text.find(row.at)));
  CAPTURE(row.at);
  CHECK(position.line == row.line);
  CHECK(position.column == row.column);
}

TEST_CASE("the end of a text and an empty text have positions", "[unit]") {
  SourceStore sources;
  const auto empty = sources.add("empty", "");
  CHECK(sources.position(empty, 0).line == 1);
  CHECK(sources.position(empty, 0).column == 1);
  CHECK(sources.line_at(empty, 0).empty());
  const auto ended = sources.add("ended", "ab\n");
  CHECK(sources.position(ended, 2).line == 1);
  CHECK(sources.position(ended, 2).column == 3);
  CHECK(sources.position(ended, 3).line == 2);
  CHECK(sources.position(ended, 3).column == 1);
}

TEST_CASE("line_at gives the line without its line end", "[unit]") {
  SourceStore sources;
  const auto file = sources.add("a.net", "one\r\ntwo\n\nfour");
  CHECK(sources.line_at(file, 0) == "one");
  CHECK(sources.line_at(file, 4) == "one");
  CHECK(sources.line_at(file, 5) == "two");
  CHECK(sources.line_at(file, 9).empty());
  CHECK(sources.line_at(file, 14) == "four");
}

TEST_CASE("text of a span is clipped to the text", "[unit]") {
  SourceStore sources;
  const auto file = sources.add("a.net", "abc");
  CHECK(sources.text(SourceSpan{file, 1, 2}) == "b");
  CHECK(sources.text(SourceSpan{file, 1, 99}) == "bc");
  CHECK(sources.text(SourceSpan{file, 2, 1}).empty());
  CHECK(sources.text(SourceSpan{}).empty());
}

TEST_CASE("cover joins spans of one file only", "[unit]") {
  const SourceSpan early{0, 2, 4};
  const SourceSpan late{0, 8, 9};
  const SourceSpan elsewhere{1, 0, 1};
  CHECK(cover(early, late) == SourceSpan{0, 2, 9});
  CHECK(cover(late, early) == SourceSpan{0, 2, 9});
  CHECK(cover(early, elsewhere) == early);
  CHECK(cover(SourceSpan{}, late) == late);
  CHECK(cover(late, SourceSpan{}) == late);
}

TEST_CASE("views of a text outlive the adding of others", "[unit]") {
  SourceStore sources;
  const std::string_view text = sources.text(sources.add("short", "abc"));
  for (int i = 0; i < 1000; ++i) {
    sources.add("more", "x");
  }
  CHECK(text.data() == sources.text(0).data());
  CHECK(text == "abc");
}
