// Decks that are wrong in every way a deck can be: status 2 within seconds and 2 GiB, a message with its place, and no file.

#include <catch2/catch.hpp>
#include <random>
#include <regex>

#include "support/scratch.hpp"
#include "support/spawn.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;
using Names = std::vector<std::string>;

namespace {

#ifdef PWLSIM_SANITIZED
constexpr double patience = 100.0;  // seconds
#else
constexpr double patience = 20.0;
#endif

/// Runs `deck` as bad.net among `scratch`'s files and checks all that must hold of a refused deck.
std::string refused(const Scratch& scratch, const std::string& deck) {
  scratch.write("bad.net", deck);
  const Names before = scratch.names();
  const Finished finished = run_program({"bad.net"}, {.folder = scratch.path().string(), .seconds = patience});
  INFO(finished.err.substr(0, 2000));
  CHECK(finished.status == 2);
  CHECK(finished.out.empty());
  CHECK(finished.seconds < patience);
  CHECK_THAT(finished.err, Contains("error[E-"));
  CHECK(scratch.names() == before);
  return finished.err;
}

std::string refused(const std::string& deck) { return refused(Scratch(), deck); }

bool has_place(const std::string& messages) {
  return std::regex_search(messages.substr(0, 4000), std::regex("[a-z]+\\.net:[0-9]+:[0-9]+: error\\[E-"));
}

const std::string good_load = "R1 a 0 1k\n";
const std::string good_source = "V1 a 0 1\n";

}  // namespace

TEST_CASE("an empty deck is refused", "[unit]") {
  const std::string deck = GENERATE(std::string(), std::string("\n"), std::string("title only\n"), std::string("title\n\n\n* comment\n"),
                                    std::string("t\n.end\n"));
  refused(deck);
}

TEST_CASE("bytes that are no text are refused", "[unit]") {
  const unsigned seed = GENERATE(1u, 2u, 3u);
  INFO("seed " << seed);
  std::mt19937 random(seed);
  std::string bytes;
  for (int count = 0; count < 200000; ++count) bytes += static_cast<char>(random() & 0xff);
  refused(bytes);
  refused(std::string(100000, '\0'));
  refused(
      "\x7f"
      "ELF\x02\x01\x01" +
      std::string(1000, '\0') + bytes);
}

TEST_CASE("a line of ten million characters is refused in time", "[unit]") {
  const std::string rest(10000000, 'x');
  CHECK(has_place(refused("t\n" + good_source + rest + " a 0 1\n.tran 1 2\n")));
  refused("t\nR1 a 0 " + rest + "\n.tran 1 2\n");
  std::string values;
  for (int count = 0; count < 1000000; ++count) values += " 1234567 8";
  refused("t\n" + good_source + "R1 a 0" + values + "\n.tran 1 2\n");
}

TEST_CASE("cards that are not understood are named with their place", "[unit]") {
  const std::string card = GENERATE("?1 a 0 1", ".nonsense a b", "Y1 a 0 1", "=", "%$#");
  CHECK(has_place(refused("t\n" + good_source + card + "\n.tran 1 2\n")));
}

TEST_CASE("cards that lack something are named with their place", "[unit]") {
  const std::string card =
      GENERATE("R1 a 0", "R1 a", "R1", "C1 a 0", "L1 a", "V1 a", "I1", "D1 a 0", "D1 a", "S1 a 0 b 0", "S1 a 0 b", "E1 a 0 b 0", "F1 a 0",
               "K1 L1", "X1", "X1 a b", ".param x", ".param =3", ".model", ".model m", ".include", ".ic v(a)=", "R1 a 0 {", "R1 a 0 {1+}",
               "R1 a 0 R=", "V1 a 0 PULSE(", ".tran", ".subckt", ".func f");
  CHECK(has_place(refused("t\nV9 a 0 1\nR9 a 0 1\n" + std::string(card) + "\n.tran 1 2\n")));
}

TEST_CASE("wrong counts of nodes are refused", "[unit]") {
  const std::string subcircuit = ".subckt two p q\nR1 p q 1\n.ends\n";
  CHECK(has_place(refused("t\n" + good_source + subcircuit + "X1 a two\n.tran 1 2\n")));
  CHECK(has_place(refused("t\n" + good_source + subcircuit + "X1 a b c two\n.tran 1 2\n")));
  CHECK(has_place(refused("t\n" + good_source + "R1 a b c 1k\n.tran 1 2\n")));
}

TEST_CASE("unknown names are refused, with the near one beside", "[unit]") {
  CHECK_THAT(refused("t\n" + good_source + "D1 a 0 mydoide\n.model mydiode D\n.tran 1 2\n"), Contains("mydiode"));
  CHECK_THAT(refused("t\n" + good_source + "X1 a filtr\n.subckt filter p\nR1 p 0 1\n.ends\n.tran 1 2\n"), Contains("filter"));
  CHECK_THAT(refused("t\n.param load=5\n" + good_source + "R1 a 0 {laod}\n.tran 1 2\n"), Contains("load"));
  CHECK(has_place(refused("t\n" + good_source + good_load + ".tran 1 2\n.save v(nowhere)\n")));
  CHECK(has_place(refused("t\n" + good_source + good_load + "F1 a 0 V7 2\n.tran 1 2\n")));
}

TEST_CASE("circles of subcircuits, includes and parameters are refused", "[unit]") {
  CHECK(has_place(refused("t\n" + good_source + "X1 a s\n.subckt s p\nX1 p s\n.ends\n.tran 1 2\n")));
  CHECK(has_place(refused("t\n" + good_source + "X1 a s\n.subckt s p\nX1 p r\n.ends\n.subckt r p\nX1 p s\n.ends\n.tran 1 2\n")));
  CHECK(has_place(refused("t\n.param a={b} b={c} c={a}\nV1 a 0 {a}\nR1 a 0 1\n.tran 1 2\n")));
  CHECK(has_place(refused("t\n.func f(x) {g(x)}\n.func g(x) {f(x)}\nV1 a 0 {f(1)}\nR1 a 0 1\n.tran 1 2\n")));
  const Scratch itself;
  CHECK(has_place(refused(itself, "t\n.include \"bad.net\"\n" + good_source + good_load + ".tran 1 2\n")));
  const Scratch pair;
  pair.write("other.net", ".include \"bad.net\"\n");
  CHECK(has_place(refused(pair, "t\n.include \"other.net\"\n" + good_source + good_load + ".tran 1 2\n")));
}

TEST_CASE("exponential expansion is refused in time", "[unit]") {
  std::string subcircuits = ".subckt s0 p\nR1 p 0 1\n.ends\n";
  for (int level = 1; level <= 60; ++level) {
    const std::string below = "s" + std::to_string(level - 1);
    subcircuits += ".subckt s" + std::to_string(level) + " p\nX1 p " + below + "\nX2 p " + below + "\n.ends\n";
  }
  refused("t\n" + good_source + subcircuits + "X1 a s60\n.tran 1 2\n");

  std::string parameters = ".param p0=1\n.func f0(x) {x+1}\n";
  for (int level = 1; level <= 90; ++level) {
    const std::string below = "f" + std::to_string(level - 1);
    parameters += ".func f" + std::to_string(level) + "(x) {" + below + "(" + below + "(x))}\n";
  }
  refused("t\n" + parameters + "V1 a 0 {f90(1)}\nR1 a 0 1\n.tran 1 2\n");
}

TEST_CASE("includes that fan out are refused in time", "[unit]") {
  const Scratch scratch;
  for (int level = 0; level < 60; ++level) {
    const std::string next = ".include \"i" + std::to_string(level + 1) + ".net\"\n";
    scratch.write("i" + std::to_string(level) + ".net", next + next);
  }
  scratch.write("i60.net", "* nothing\n");
  refused(scratch, "t\n.include \"i0.net\"\n" + good_source + good_load + ".tran 1 2\n");
}

TEST_CASE("depth beyond the limits is refused", "[unit]") {
  const std::size_t depth = 100000;
  const std::string deep = std::string(depth, '(') + "1" + std::string(depth, ')');
  CHECK(has_place(refused("t\n" + good_source + "R1 a 0 {" + deep + "}\n.tran 1 2\n")));
  refused("t\n" + good_source + "R1 a 0 {" + std::string(depth, '(') + "\n.tran 1 2\n");
  refused("t\n" + good_source + "R1 a 0 " + deep + "\n.tran 1 2\n");
  refused("t\n" + good_source + "R1 a 0 " + std::string(depth, '[') + "\n.tran 1 2\n");
  refused("t\nV1 a 0 {" + std::string(depth, '-') + "x}\n" + good_load + ".tran 1 2\n");
  refused("t\nV1 a 0 {" + std::string(depth, '!') + "1}\n" + good_load + ".tran 1 2\n");
  std::string conditions = "{";
  for (std::size_t count = 0; count < depth; ++count) conditions += "1?";
  refused("t\nV1 a 0 " + conditions + "\n" + good_load + ".tran 1 2\n");
  std::string subcircuits;
  for (int level = 0; level < 200; ++level)
    subcircuits += ".subckt n" + std::to_string(level) + " p\nX1 p n" + std::to_string(level + 1) + "\n.ends\n";
  CHECK(has_place(refused("t\n" + good_source + subcircuits + ".subckt n200 p\nR1 p 0 1\n.ends\nX1 a n0\n.tran 1 2\n")));
}

TEST_CASE("sources that contradict each other are refused", "[unit]") {
  CHECK_THAT(refused("t\nV1 a 0 1\nV2 a 0 2\nR1 a 0 1\n.tran 1 2\n"), Contains("V1") || Contains("V2"));
  CHECK_THAT(refused("t\nI1 0 a 1\nI2 a b 2\nR1 b 0 1\n.tran 1 2\n"), Contains("I1") || Contains("I2") || Contains("a"));
  refused("t\nV1 a 0 1\nE1 a 0 a 0 2\nR1 a 0 1\n.tran 1 2\n");
}

TEST_CASE("times that make no sense are refused", "[unit]") {
  const std::string card = GENERATE(".tran -1 2", ".tran 1 -2", ".tran 1 2 -1", ".tran 1 2 3", ".tran 0", ".tran 0 0", ".tran 1n 10",
                                    ".tran inf 2", ".tran 1 inf", ".tran a b", ".tran {1/0} 2", ".tran 1 2 3 4 5 6");
  CHECK(has_place(refused("t\n" + good_source + good_load + std::string(card) + "\n")));
}

TEST_CASE("a deck without an analysis is refused", "[unit]") { refused("t\n" + good_source + good_load); }

TEST_CASE("two elements of one name are refused", "[unit]") {
  CHECK(has_place(refused("t\n" + good_source + "RL a 0 1\nRl a 0 2\n.tran 1 2\n")));
}

TEST_CASE("all errors of a deck are reported in one go", "[unit]") {
  const std::string messages = refused("t\nV1 a 0 1\nR1 a 0 {nix}\nR2 a\nD1 a 0 nomodel\n.nonsense\n.tran 1 -2\n");
  for (const char* place : {"bad.net:3:", "bad.net:4:", "bad.net:5:", "bad.net:6:", "bad.net:7:"}) CHECK_THAT(messages, Contains(place));
}

TEST_CASE("a floating part is named or solved, never a crash", "[unit]") {
  const Scratch scratch;
  // Node c has no path to ground through which its voltage could be known.
  const std::string messages = refused(scratch, "t\n" + good_source + good_load + "I1 c d 1\nR2 c d 1k\nI2 0 c 1m\n.tran 1 2\n");
  CHECK(
      (messages.find("`c`") != std::string::npos || messages.find("`d`") != std::string::npos || messages.find(" c") != std::string::npos));
}
