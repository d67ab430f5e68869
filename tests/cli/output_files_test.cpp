// Names of outputs that lead to what was read, to one another, to links, or nowhere.

#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "cli/run_in.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;
using Names = std::vector<std::string>;

namespace {

const std::string deck_with_parts = "d\n.include part.inc\n.lib models.lib tt\nV1 a 0 SIN(0 1 50)\n.save v(a)\n.tran 1m 20m\n";
const std::string part = "R1 a 0 1k\n";
const std::string models = ".lib tt\nR2 a 0 1k\n.endl tt\n";

struct Included : Scratch {
  Included() {
    write("d.net", deck_with_parts);
    write("part.inc", part);
    write("models.lib", models);
  }
};

void refused(const Scratch& scratch, const Names& arguments, int status, const std::string& message) {
  const Names before = scratch.names();
  const Finished finished = run_in(scratch, arguments);
  CHECK(finished.status == status);
  CHECK_THAT(finished.err, Contains(message));
  CHECK(scratch.names() == before);
}

}  // namespace

TEST_CASE("an output never replaces a file that the deck includes", "[regression]") {
  const Included scratch;
  const std::string option = GENERATE(std::string("-o"), std::string("--stats"));
  refused(scratch, {"d.net", option, "part.inc"}, 2, "error[E-output-is-deck]: part.inc is a file that the deck reads; try another name");
  refused(scratch, {"d.net", option, "./models.lib"}, 2, "error[E-output-is-deck]: ./models.lib is a file that the deck reads");
  std::filesystem::create_symlink("part.inc", scratch / "link.csv");
  refused(scratch, {"d.net", option, "link.csv"}, 2, "error[E-output-is-deck]: link.csv is a file that the deck reads");
  std::filesystem::create_hard_link(scratch / "part.inc", scratch / "hard.csv");
  refused(scratch, {"d.net", option, "hard.csv"}, 2, "error[E-output-is-deck]: hard.csv is a file that the deck reads");
  CHECK(read_file(scratch / "part.inc") == part);
  CHECK(read_file(scratch / "models.lib") == models);
}

TEST_CASE("pictures, pages, exported decks and files of --split do not replace an included file either", "[regression]") {
  const Included scratch;
  for (const std::string name : {"part.svg", "part.html", "part.2.csv"}) {
    scratch.write(name, part);
    scratch.write("x.net", "x\n.include " + name + "\nV1 a 0 1\n.step param p list 1 2\n.save v(a)\n.tran 1 2\n");
    const Names arguments = name == "part.svg"    ? Names{"x.net", "--plot", name}
                            : name == "part.html" ? Names{"x.net", "--report", name}
                                                  : Names{"x.net", "--split", "-o", "part.csv"};
    refused(scratch, arguments, 2, "error[E-output-is-deck]: " + name + " is a file that the deck reads");
    CHECK(read_file(scratch / name) == part);
  }
  refused(scratch, {"export", "d.net", "-o", "part.inc"}, 2, "error[E-output-is-deck]: part.inc is a file that the deck reads");
}

TEST_CASE("the rows of a system read by .lcs are no output", "[regression]") {
  const Scratch scratch;
  scratch.write("s.lcs", "A\n-1\nB\n0\nC\n1\nD\n1\nx0\n1\n");
  scratch.write("l.net", "l\n.lcs s \"s.lcs\"\n.tran 1m 2m\n");
  CHECK(run_in(scratch, {"l.net", "-o", "-"}).status == 0);
  refused(scratch, {"l.net", "-o", "s.lcs"}, 2, "error[E-output-is-deck]: s.lcs is a file that the deck reads");
  CHECK_THAT(read_file(scratch / "s.lcs"), Contains("x0"));
}

TEST_CASE("a deck named like the temporary file of an output survives", "[regression]") {
  const Scratch scratch;
  scratch.write("a.csv.partial", "d\nV1 a 0 1\nR1 a 0 1\n.tran 1 2\n");
  refused(scratch, {"a.csv.partial", "-o", "a.csv"}, 2, "error[E-output-is-deck]: a.csv.partial is the deck itself");
  CHECK_THAT(read_file(scratch / "a.csv.partial"), Contains("V1 a 0 1"));
}

TEST_CASE("a symbolic link to a file that does not exist yet is written through", "[regression]") {
  const Included scratch;
  std::filesystem::create_directory(scratch / "results");
  std::filesystem::create_symlink("results/real.csv", scratch / "link.csv");
  std::filesystem::create_symlink("link.csv", scratch / "second.csv");
  const std::string name = GENERATE(std::string("link.csv"), std::string("second.csv"));
  CHECK(run_in(scratch, {"d.net", "-o", name}).status == 0);
  CHECK(std::filesystem::is_symlink(scratch / name));
  CHECK(read_file(scratch / "results/real.csv").starts_with("time,v(a)\n0,0\n"));
  refused(scratch, {"d.net", "-o", "link.csv", "--stats", "results/real.csv"}, 2, "error[E-option-conflict]");
}

TEST_CASE("two names of one file that does not exist yet are one target", "[regression]") {
  const Included scratch;
  std::filesystem::create_symlink("real.csv", scratch / "link.csv");
  refused(scratch, {"d.net", "-o", "link.csv", "--stats", "real.csv"}, 2, "error[E-option-conflict]: the rows and `--stats`");
  refused(scratch, {"d.net", "-o", "new.csv", "--stats", "./new.csv"}, 2, "error[E-option-conflict]: the rows and `--stats`");
}

TEST_CASE("a link to itself, a directory, a folder that is not there and a full device are named", "[unit]") {
  const Included scratch;
  std::filesystem::create_symlink("loop.csv", scratch / "loop.csv");
  std::filesystem::create_directory(scratch / "folder");
  refused(scratch, {"d.net", "-o", "loop.csv"}, 3, "error[E-cannot-write]: loop.csv: Too many levels of symbolic links");
  refused(scratch, {"d.net", "-o", "folder"}, 3, "error[E-cannot-write]: folder: Is a directory");
  refused(scratch, {"d.net", "-o", "none/a.csv"}, 3, "error[E-cannot-write]: none/a.csv: No such file or directory");
  refused(scratch, {"d.net", "-o", "/dev/full"}, 3, "error[E-cannot-write]: /dev/full: No space left on device");
}

TEST_CASE("an included pipe or directory is named as what it is", "[regression]") {
  const Scratch scratch;
  std::filesystem::create_directory(scratch / "folder");
  REQUIRE(::mkfifo((scratch / "pipe").c_str(), 0600) == 0);
  std::filesystem::create_symlink("nowhere", scratch / "dangling");
  const auto [name, kind] =
      GENERATE(table<std::string, std::string>({{"folder", "it is a directory"},
                                                {"pipe", "it is a pipe, and only regular files can be included"},
                                                {"/dev/null", "it is a device or socket, and only regular files can be included"},
                                                {"dangling", "it is a symbolic link to a file that does not exist"},
                                                {"none", "no such file beside the file that names it"}}));
  scratch.write("d.net", "d\n.include " + name + "\nV1 a 0 1\n.op\n");
  refused(scratch, {"d.net"}, 3, "d.net:2:10: error[E-include-unreadable]: cannot read '" + name + "': " + kind);
}

TEST_CASE("a deck that includes itself is refused", "[unit]") {
  const Scratch scratch;
  scratch.write("d.net", "d\n.include d.net\nV1 a 0 1\nR1 a 0 1\n.op\n");
  const Finished finished = run_in(scratch, {"d.net"});
  CHECK(finished.status == 2);
  CHECK_THAT(finished.err, Contains("error[E-include-recursion]: 'd.net' includes itself"));
}
