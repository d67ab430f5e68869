#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "netlist/tree_text.hpp"

namespace {

namespace fs = std::filesystem;

/// A folder of its own, gone with the test.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("pwlsim-include-test-" + std::to_string(::getpid()))) { fs::create_directories(path_); }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] std::string path(const std::string& name) const { return (path_ / name).string(); }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories(fs::path(path(name)).parent_path());
    std::ofstream(path(name), std::ios::binary) << text;
  }

 private:
  fs::path path_;
};

/// What a file on disk gives.
struct Loaded {
  pwlsim::SourceStore sources;
  pwlsim::Diagnostics diagnostics;
  pwlsim::netlist::Loaded loaded;

  explicit Loaded(const std::string& path) { loaded = pwlsim::netlist::load(path, sources, diagnostics); }

  [[nodiscard]] std::string cards() const {
    std::string text;
    for (const auto& card : loaded.deck.cards) {
      text += tree_text::text_of(card) + "\n";
    }
    return text;
  }
  [[nodiscard]] std::string messages() const {
    std::string text;
    for (const auto& diagnostic : diagnostics.all()) {
      text += diagnostic.id + " «" + std::string(sources.text(diagnostic.span)) + "»\n";
    }
    return text;
  }
};

/// Sets the current directory for the time of a test.
class CurrentDirectory {
 public:
  explicit CurrentDirectory(const std::string& path) : before_(fs::current_path()) { fs::current_path(path); }
  ~CurrentDirectory() { fs::current_path(before_); }
  CurrentDirectory(const CurrentDirectory&) = delete;
  CurrentDirectory& operator=(const CurrentDirectory&) = delete;

 private:
  fs::path before_;
};

}  // namespace

TEST_CASE("an unreadable deck is said to be so", "[unit]") {
  const Folder folder;
  const Loaded missing(folder.path("none.net"));
  CHECK_FALSE(missing.loaded.readable);
  CHECK(missing.messages() == "E-file-unreadable «»\n");
  CHECK_FALSE(Loaded(folder.path("")).loaded.readable);  // a directory
}

TEST_CASE("includes are read in place, without a title line", "[unit]") {
  const Folder folder;
  folder.write("deck.net", "title\nR1 a b 1\n.include \"sub/one.inc\"\nR4 a b 4\n.inc two.inc\n.end\nR9\n");
  folder.write("sub/one.inc", "R2 a b 2\n.INCLUDE 'beside.inc' ; next to this file\n");
  folder.write("sub/beside.inc", "R3 a b 3\n.end\nR9 a b 9\n");
  folder.write("two.inc", "R5 a b 5");
  const Loaded loaded(folder.path("deck.net"));
  CHECK(loaded.messages().empty());
  CHECK(loaded.cards() == "R1 a b 1\nR2 a b 2\nR3 a b 3\nR4 a b 4\nR5 a b 5\n");
  CHECK(loaded.sources.name(loaded.loaded.deck.cards.at(2).span.file) == folder.path("sub/beside.inc"));
}

TEST_CASE("tiny files that include others are read to their end", "[unit]") {
  const Folder folder;
  folder.write("d", "t\n.inc a\nR9 z");
  folder.write("a", ".inc b\nR1 a");
  folder.write("b", ".inc c\nR2 b");
  folder.write("c", "R3 c");
  const Loaded loaded(folder.path("d"));
  CHECK(loaded.messages().empty());
  CHECK(loaded.cards() == "R3 c\nR2 b\nR1 a\nR9 z\n");
}

TEST_CASE("includes are sought beside the file first, then in the current directory", "[unit]") {
  const Folder folder;
  folder.write("decks/deck.net", "title\n.include both.inc\n.include here.inc\n.include sub\\back.inc\n");
  folder.write("decks/both.inc", "R1 beside\n");
  folder.write("here/both.inc", "R1 current\n");
  folder.write("here/here.inc", "R2 current\n");
  folder.write("decks/sub/back.inc", "R3 slashes\n");
  const CurrentDirectory here(folder.path("here"));
  const Loaded loaded(folder.path("decks/deck.net"));
  CHECK(loaded.messages().empty());
  CHECK(loaded.cards() == "R1 beside\nR2 current\nR3 slashes\n");
}

TEST_CASE("errors in included files stand where they are", "[unit]") {
  const Folder folder;
  folder.write("deck.net", "title\n.include bad.inc\n.include bad.inc\n");
  folder.write("bad.inc", "R1 a b (\n\nR2 \x01\n");
  const Loaded loaded(folder.path("deck.net"));
  // The file is read twice, its errors are told once.
  CHECK(loaded.messages() == "E-syntax-control-character «\x01»\nN-parenthesis «(»\n");
  CHECK(loaded.sources.name(loaded.diagnostics.all().at(0).span.file) == folder.path("bad.inc"));
}

TEST_CASE("include cards that cannot be followed", "[unit]") {
  const Folder folder;
  struct Row {
    const char* card;
    const char* messages;
  };
  const auto row = GENERATE(Row{".include none.inc", "E-include-unreadable «none.inc»\n"},
                            Row{".include \"no ne.inc\"", "E-include-unreadable «\"no ne.inc\"»\n"},
                            Row{".include", "E-syntax-include «.include»\n"}, Row{".lib", "E-syntax-include «.lib»\n"},
                            Row{".include a b", "E-syntax-include «b»\n"}, Row{".lib a b c", "E-syntax-include «c»\n"},
                            Row{".include \"a", "E-syntax-unclosed «\"»\n"}, Row{".lib none.lib", "E-include-unreadable «none.lib»\n"},
                            Row{".lib C:\\LTspice\\lib\\cmp\\standard.dio", "W-lib-skipped «C:\\LTspice\\lib\\cmp\\standard.dio»\n"},
                            Row{".lib \"C:/Users/me/own.lib\"", "W-lib-skipped «\"C:/Users/me/own.lib\"»\n"},
                            Row{".lib Standard.MOS", "W-lib-skipped «Standard.MOS»\n"},
                            Row{".include \"C:\\a b\\own.Sub\"", "W-lib-skipped «\"C:\\a b\\own.Sub\"»\n"},
                            Row{".include C:\\own.net", "E-include-unreadable «C:\\own.net»\n"},
                            Row{".include standard.dio", "E-include-unreadable «standard.dio»\n"}, Row{".endl", "E-syntax-lib «.endl»\n"});
  folder.write("deck.net", std::string("title\nR1 a b 5\n") + row.card + "\n");
  CAPTURE(row.card);
  CHECK(Loaded(folder.path("deck.net")).messages() == row.messages);
}

TEST_CASE("sections of a library", "[unit]") {
  const Folder folder;
  folder.write("two.lib", "R0 outside\n.lib fast\nR1 fast\n.endl fast\n.LIB Slow\nR2 slow\n.lib 'two.lib' fast\n.endl\n");
  SECTION("one is chosen, in any case, and may use another") {
    folder.write("deck.net", "title\n.lib \"two.lib\" SLOW\n");
    const Loaded loaded(folder.path("deck.net"));
    CHECK(loaded.messages().empty());
    CHECK(loaded.cards() == "R2 slow\nR1 fast\n");
  }
  SECTION("without a section the cards outside of sections are read") {
    folder.write("deck.net", "title\n.lib two.lib\n");
    const Loaded loaded(folder.path("deck.net"));
    CHECK(loaded.messages().empty());
    CHECK(loaded.cards() == "R0 outside\n");
  }
  SECTION("one that does not exist is an error with a near name") {
    folder.write("deck.net", "title\nR1 a b 5\n.lib two.lib slwo\n");
    const Loaded loaded(folder.path("deck.net"));
    CHECK(loaded.messages() == "E-lib-section «slwo»\n");
    CHECK(loaded.diagnostics.all().at(0).text.find("try Slow") != std::string::npos);
  }
}

TEST_CASE("files that include themselves or nest too deep", "[unit]") {
  const Folder folder;
  folder.write("deck.net", "title\nR1 a b 5\n.include deck.net\n");
  CHECK(Loaded(folder.path("deck.net")).messages() == "E-include-recursion «deck.net»\n");
  folder.write("a.inc", ".include b.inc\n");
  folder.write("sub/empty", "");
  folder.write("b.inc", "R2 a b 5\n.include sub/../a.inc\n");
  folder.write("circle.net", "title\n.include a.inc\n");
  const Loaded circle(folder.path("circle.net"));
  CHECK(circle.messages() == "E-include-recursion «sub/../a.inc»\n");
  CHECK(circle.cards() == "R2 a b 5\n");
  for (int i = 0; i < 120; ++i) {
    folder.write("deep" + std::to_string(i) + ".inc", ".include deep" + std::to_string(i + 1) + ".inc\nR" + std::to_string(i) + " a b 5\n");
  }
  folder.write("deep.net", "title\n.include deep0.inc\n");
  const Loaded deep(folder.path("deep.net"));
  CHECK(deep.messages() == "E-include-depth «deep100.inc»\n");
  CHECK(deep.loaded.deck.cards.size() == 100);
  folder.write("deep120.inc", "R120 a b 5\n");
  folder.write("deeper.net", "title\n.options max_include_depth=150\n.include deep0.inc\n");
  CHECK(Loaded(folder.path("deeper.net")).messages().empty());
}

TEST_CASE("includes that multiply are stopped", "[unit]") {
  const Folder folder;
  folder.write("deck.net", "title\n.include d0.inc\n");
  for (int i = 0; i < 40; ++i) {
    const std::string next = ".include d" + std::to_string(i + 1) + ".inc\n";
    folder.write("d" + std::to_string(i) + ".inc", next + next);
  }
  folder.write("d40.inc", "R1 a b 5\n");
  CHECK(Loaded(folder.path("deck.net")).messages().find("E-include-repeated") == 0);
}
