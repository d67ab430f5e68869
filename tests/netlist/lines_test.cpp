#include <catch2/catch.hpp>

#include "netlist/tree_text.hpp"

using tree_text::Read;

TEST_CASE("the first line is the title, always", "[unit]") {
  struct Row {
    const char* text;
    const char* title;
    const char* cards;
  };
  const auto row =
      GENERATE(Row{"Buck\nR1 a b 5\n", "Buck", "R1 a b 5\n"}, Row{"R1 a b 5\nR2 c d 6\n", "R1 a b 5", "R2 c d 6\n"},
               Row{"* Buck\r\nR1 a b 5\r\n", "* Buck", "R1 a b 5\n"}, Row{"\nR1 a b 5", "", "R1 a b 5\n"},
               Row{"\xEF\xBB\xBFTitle\nR1 a b 5\n", "Title", "R1 a b 5\n"}, Row{"  spaced  \nR1 a b 5\n", "spaced", "R1 a b 5\n"});
  const Read read(row.text);
  CHECK(read.deck.title == row.title);
  CHECK(read.cards() == row.cards);
  CHECK(read.messages().empty());
}

TEST_CASE("a dot card on the title line is a likely slip", "[unit]") {
  CHECK(Read(".tran 1u 1m\nR1 a b 5\n").messages() == "W-title-card «.tran 1u 1m»\n");
  CHECK(Read(".title Buck\nR1 a b 5\n").messages().empty());
  CHECK(Read("...\nR1 a b 5\n").messages().empty());
}

TEST_CASE("comments and continuations", "[unit]") {
  struct Row {
    const char* text;
    const char* cards;
  };
  const auto row =
      GENERATE(Row{"* all\n  * of it\nR1 a b 5\n", "R1 a b 5\n"}, Row{"R1 a b 5 ; c\n", "R1 a b 5\n"}, Row{"R1 a b 5;c\n", "R1 a b 5\n"},
               Row{"R1 a b 5 $ c\n", "R1 a b 5\n"}, Row{"R1 a b 5\t$\tc\n", "R1 a b 5\n"}, Row{"R1 a b 5 $\n", "R1 a b 5\n"},
               Row{"$ c\nR1 a b 5\n", "R1 a b 5\n"}, Row{"R1 a$b $c 5\n", "R1 a$b $c 5\n"}, Row{"R1 a b 5 // c\n", "R1 a b 5\n"},
               Row{"// c\nR1 a b 5//c\n", "R1 a b 5\n"}, Row{"; c\n;\nR1 a b 5\n", "R1 a b 5\n"}, Row{"R1 a/b c 5\n", "R1 a/b c 5\n"},
               Row{"V1 a 0 PWL file=\"a;b//c $ d\" ; e\n", "V1 a 0 PWL file=\"a;b//c $ d\"\n"}, Row{"R1 a\n+ b\n+5\n", "R1 a b 5\n"},
               Row{"R1 a ; c\n* between\n\n  + b 5\n", "R1 a b 5\n"}, Row{"R1 a\n+\n+ b 5\n", "R1 a b 5\n"},
               Row{"R1 a\n; between\n+ b ; c\n+ 5 $ c\n", "R1 a b 5\n"}, Row{"R1 a\r\n+ b 5\r\n", "R1 a b 5\n"},
               Row{"R1 a b {x\n+ +\n+ y}\n", "R1 a b {(x+y)}\n"}, Row{"R1 a b 5\n* +5\nR2 c d 6\n", "R1 a b 5\nR2 c d 6\n"},
               Row{".param a=b\n+ * c\n", ".param a={(b*c)}\n"}, Row{"R1 a b 5\n\n\n\n", "R1 a b 5\n"}, Row{"R1 a b 5", "R1 a b 5\n"},
               Row{"V1 a 0 PWL(0 0,\n+ 1 1)\n", "V1 a 0 PWL(0 0 1 1)\n"}, Row{"R1 a\u00A0b 5\n", "R1 a b 5\n"});
  CAPTURE(row.text);
  const Read read(std::string("title\n") + row.text);
  CHECK(read.messages().empty());
  CHECK(read.cards() == row.cards);
}

TEST_CASE("a continuation of nothing is an error", "[unit]") {
  CHECK(Read("title\n+ R1 a b\nR2 c d 5\n").messages() == "E-syntax-continuation «R1 a b»\n");
  CHECK(Read("title\n* c\n+ x\nR2 c d 5\n").cards() == "R2 c d 5\n");
}

TEST_CASE("the deck ends at .end, whatever follows", "[unit]") {
  const std::string text = "title\nR1 a b 5\n.END\nR2 c d (\n\x01\n";
  const Read read(text + std::string("\0\0", 2));
  CHECK(read.messages().empty());
  CHECK(read.cards() == "R1 a b 5\n");
}

TEST_CASE("texts in other encodings", "[unit]") {
  CHECK(Read("title\nC1 a b 1\xB5\x46\n").cards() == "C1 a b 1\u00B5F\n");  // Latin-1
  CHECK(Read("title \xE9t\xE9\nR1 a b 5 ; \x96\n").deck.title == "title \u00E9t\u00E9");
  const std::string utf16_little("\xFF\xFEt\0\n\0R\0001\0 \0\xB5\0 \0b\0\n\0", 20);
  CHECK(Read(utf16_little).cards() == "R1 \u00B5 b\n");
  const std::string utf16_big("\xFE\xFF\0t\0\n\0R\0001\0 \0\xB5\0 \0b\0\n", 20);
  CHECK(Read(utf16_big).cards() == "R1 \u00B5 b\n");
  CHECK(Read(utf16_big).messages().empty());
}

TEST_CASE("control characters are errors with their place", "[unit]") {
  const Read read("title\nR1 a\x07 b 5\nR2 c\rd 6\nR3 e\x7F 7\nR4 \xC2\x85 8\nR5 a\x81 b\n");
  CHECK(read.messages() ==
        "E-syntax-control-character «\x07»\nE-syntax-control-character «\r»\nE-syntax-control-character «\x7F»\n"
        "E-syntax-control-character «\xC2\x85»\nE-syntax-control-character «\xEF\xBF\xBD»\n");
  CHECK(read.diagnostics.all().at(0).text.find("U+0007") != std::string::npos);
  CHECK(read.diagnostics.all().at(3).text.find("U+0085") != std::string::npos);
  CHECK(read.sources.position(0, read.diagnostics.all().at(0).span.begin).line == 2);
  CHECK(read.sources.position(0, read.diagnostics.all().at(0).span.begin).column == 5);
}

TEST_CASE("a binary file gives one error", "[unit]") {
  std::string bytes =
      "\x7F"
      "ELF\x02\x01\x01";
  for (int i = 0; i < 100'000; ++i) {
    bytes.push_back(static_cast<char>(i * 7919 % 256));
  }
  const Read read(bytes);
  REQUIRE(read.diagnostics.all().size() == 1);
  CHECK(read.diagnostics.all()[0].id == "E-syntax-binary");
  CHECK(read.deck.cards.empty());
}

TEST_CASE("a deck without cards is an error", "[unit]") {
  CHECK(Read("").messages() == "E-syntax-empty «»\n");
  CHECK(Read("\n\n").messages() == "E-syntax-empty «»\n");
  CHECK(Read("R1 a b 5").messages() == "E-syntax-empty «R1 a b 5»\n");
  CHECK(Read("title\n* only\n.end\n").messages() == "E-syntax-empty «title»\n");
}

TEST_CASE("control blocks are skipped with one note", "[unit]") {
  const Read read("title\n.control\nrun $ go\nlet a = (\nplot v(a) \"\n.endc\nR1 a b 5\n.control\n.endc\n.tran 1u 1m\n.end\n");
  CHECK(read.messages() == "N-control-skipped «.control»\n");
  CHECK(read.cards() == "R1 a b 5\n.tran 1u 1m\n");
}

TEST_CASE("a deck without .tran takes tran from its control block", "[unit]") {
  const Read read("title\n.control\n  TRAN 1u\n+ 1m $ c\ntran 2u 2m\n.endc\nR1 a b 5\n");
  CHECK(read.messages() == "N-control-skipped «.control»\n");
  CHECK(read.cards() == "R1 a b 5\n.tran 1u 1m\n");
  CHECK(std::string(read.sources.text(read.deck.cards.back().name_span)) == "TRAN");
  // What is not used is not judged.
  CHECK(Read("title\n.control\ntran 1u (\n.endc\n.tran 1u 1m\n").messages() == "N-control-skipped «.control»\n");
  CHECK(Read("title\n.control\ntran 1u (\n.endc\nR1 a b 5\n").messages() == "N-parenthesis «(»\nN-control-skipped «.control»\n");
}

TEST_CASE("control blocks that do not match are errors", "[unit]") {
  CHECK(Read("title\nR1 a b 5\n.control\nrun\n").messages() == "E-syntax-control «.control»\nN-control-skipped «.control»\n");
  CHECK(Read("title\nR1 a b 5\n.endc\n").messages() == "E-syntax-control «.endc»\n");
}
