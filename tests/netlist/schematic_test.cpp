// Schematics of LTspice as netlists. Where pins lie, and what turning and mirroring does to them, are facts of LTspice's files: the places written here were
// read off its own schematics and symbols.

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <random>

#include <fmt/format.h>

#include "netlist/load.hpp"
#include "netlist/schematic/netlister.hpp"
#include "support/scratch.hpp"

namespace {

using namespace pwlsim;
using test::Scratch;

/// A schematic in memory, its symbols and blocks in `folder`.
struct Made {
  SourceStore sources;
  Diagnostics diagnostics;
  std::string text;

  explicit Made(const std::string& schematic, const std::filesystem::path& folder = "/nowhere") {
    const FileIndex file = sources.add("x.asc", schematic);
    text = netlist::netlist_of(file, folder, sources, diagnostics).text;
  }
  [[nodiscard]] std::string messages() const {
    std::string all;
    for (const Diagnostic& diagnostic : diagnostics.all()) all += diagnostic.id + " «" + std::string(sources.text(diagnostic.span)) + "»\n";
    return all;
  }
};

void write(const Scratch& scratch, const std::string& name, const std::string& text) {
  const std::filesystem::path path = scratch.path() / name;
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

/// A boost converter: three kinds of nodes (labelled, ground, neither), a T junction, a crossing, attributes in any order.
const std::string boost = R"(Version 4
SHEET 1 880 680
WIRE 96 96 0 96
WIRE 256 96 176 96
WIRE 320 96 256 96
WIRE 480 96 384 96
WIRE 480 160 480 96
WIRE 0 112 0 96
WIRE 256 128 256 96
WIRE 208 208 144 208
WIRE 144 224 144 208
FLAG 0 192 0
FLAG 256 224 0
FLAG 144 304 0
FLAG 480 224 0
FLAG 480 96 out
IOPIN 480 96 Out
SYMBOL voltage 0 96 R0
WINDOW 123 0 0 Left 2
SYMATTR InstName V1
SYMATTR Value 12
SYMBOL ind 80 112 R270
WINDOW 0 32 56 VTop 2
SYMATTR SpiceLine Rser=10m
SYMATTR InstName L1
SYMATTR Value 100µ
SYMBOL nmos 208 128 R0
SYMATTR InstName Q1
SYMATTR Value IRF540
SYMBOL voltage 144 208 R0
SYMATTR InstName V2
SYMATTR Value PULSE(0 10 0 0 0 5u 10u)
SYMATTR Value2 AC 1
SYMBOL schottky 320 112 R270
SYMATTR InstName D1
SYMBOL cap 464 160 R0
SYMATTR InstName C1
SYMATTR Value 47µ
SYMATTR SpiceLine2 Cpar=1n
TEXT 0 400 Left 2 !.tran 1m\n.save V(out) Id(M§Q1)
TEXT 0 440 Left 2 ;.tran 2m
RECTANGLE Normal 1 2 3 4 2
)";

}  // namespace

TEST_CASE("a schematic becomes the netlist that LTspice makes of it", "[unit]") {
  const Made made(boost);
  CHECK(made.messages().empty());
  CHECK(made.text ==
        "* x.asc\n"
        "V1 N001 0 12\n"
        "L1 N001 N002 100µ Rser=10m\n"
        "MQ1 N002 N003 0 0 IRF540\n"
        "V2 N003 0 PULSE(0 10 0 0 0 5u 10u) AC 1\n"
        "D1 N002 out D\n"
        "C1 out 0 47µ Cpar=1n\n"
        ".model D D\n"
        ".lib standard.dio\n"
        ".model NMOS NMOS\n"
        ".model PMOS PMOS\n"
        ".lib standard.mos\n"
        ".tran 1m\n"
        ".save V(out) Id(MQ1)\n"
        ".backanno\n"
        ".end\n");
}

TEST_CASE("symbols are turned, then mirrored", "[unit]") {
  struct Turned {
    const char* orientation;
    int first_x, first_y, second_x, second_y;
  };
  // Of a symbol whose pins lie at (16,16) and (16,96).
  const Turned all[] = {{"R0", 16, 16, 16, 96},   {"R90", -16, 16, -96, 16}, {"R180", -16, -16, -16, -96}, {"R270", 16, -16, 96, -16},
                        {"M0", -16, 16, -16, 96}, {"M90", 16, 16, 96, 16},   {"M180", 16, -16, 16, -96},   {"M270", -16, -16, -96, -16}};
  for (const Turned& turned : all) {
    INFO(turned.orientation);
    const Made made(fmt::format("Version 4\nFLAG {} {} a\nFLAG {} {} b\nSYMBOL res 1000 2000 {}\nSYMATTR InstName R1\nSYMATTR Value 1k\n",
                                1000 + turned.first_x, 2000 + turned.first_y, 1000 + turned.second_x, 2000 + turned.second_y,
                                turned.orientation));
    CHECK(made.text.find("R1 a b 1k\n") != std::string::npos);
  }
}

TEST_CASE("wires meet at ends that lie on others, and do not where they cross", "[unit]") {
  const std::string symbols =
      "SYMBOL res -16 -16 R0\nSYMATTR InstName R1\nSYMATTR Value 1\nSYMBOL res 84 -16 R0\nSYMATTR InstName R2\nSYMATTR Value 2\n";
  const auto joined = [&](const std::string& wires) {
    // R1 hangs at (0,0), R2 at (100,0).
    return Made("Version 4\n" + wires + symbols).text.find("R2 N001 ") != std::string::npos;
  };
  CHECK(joined("WIRE 0 0 100 0\n"));
  CHECK(joined("WIRE -50 0 100 0\n"));                                                 // a pin on a wire
  CHECK(joined("WIRE 0 0 0 -50\nWIRE -50 -50 50 -50\nWIRE 50 -50 100 0\n"));           // a T, and a wire aslant
  CHECK_FALSE(joined("WIRE 0 0 0 -100\nWIRE -50 -50 100 -50\nWIRE 100 -50 100 0\n"));  // a crossing
  CHECK(joined("FLAG 0 0 N001\nFLAG 100 0 n001\n"));                                   // labels of one name
  CHECK(joined("FLAG 0 0 N001\nSYMBOL Misc\\\\jumper 50 -64 R0\nSYMATTR InstName X1\nWIRE 0 0 18 0\nWIRE 82 0 100 0\n"));
}

TEST_CASE("a net with two labels has both names", "[unit]") {
  const Made made(
      "Version 4\nFLAG 16 16 a\nFLAG 16 16 b\nFLAG 16 96 0\nFLAG 16 96 com\nSYMBOL res 0 0 R0\nSYMATTR InstName R1\nSYMATTR Value 1\n");
  CHECK(made.text == "* x.asc\nR1 a 0 1\nR_label_b b a 0\nR_label_com com 0 0\n.backanno\n.end\n");
}

TEST_CASE("unused pins of LTspice's own devices go to their common", "[unit]") {
  const Made made(
      "Version 4\nFLAG -32 32 a\nFLAG -32 48 b\nFLAG 32 48 q\nFLAG -16 96 com\nSYMBOL Digital\\\\and 0 0 R0\nSYMATTR InstName A1\nSYMATTR "
      "Value2 Td=1n\n"
      "FLAG 200 64 a\nFLAG 264 64 nq\nSYMBOL Digital\\\\inv 200 0 R0\nSYMATTR InstName U7\n");
  CHECK(made.messages().empty());
  CHECK(made.text.find("A1 a b com com com com q com AND Td=1n\n") != std::string::npos);
  CHECK(made.text.find("AU7 a 0 0 0 0 nq 0 0 BUF\n") != std::string::npos);
}

TEST_CASE("symbols beside the schematic", "[unit]") {
  const Scratch scratch;
  write(scratch, "parts/Driver.asy",
        "Version 4\r\nSymbolType CELL\r\nSYMATTR Value driver\r\nSYMATTR Prefix X\r\nSYMATTR ModelFile driver.lib\r\nSYMATTR SpiceLine "
        "gain=2\r\n"
        "PIN 0 0 LEFT 8\r\nPINATTR PinName out\r\nPINATTR SpiceOrder 2\r\nPIN 64 0 RIGHT 8\r\nPINATTR PinName in\r\nPINATTR SpiceOrder "
        "1\r\n");
  write(scratch, "res.asy", "Version 4\nSYMATTR Prefix R\nSYMATTR Value 5\nPIN 0 0 NONE 0\nPIN 0 32 NONE 0\n");
  const Made made(
      "Version 4\nFLAG 0 0 o\nFLAG 64 0 i\nSYMBOL parts\\\\driver 0 0 R0\nSYMATTR InstName U1\n"
      "FLAG 200 0 a\nFLAG 200 32 b\nSYMBOL res 200 0 R0\nSYMATTR InstName R1\n",
      scratch.path());
  CHECK(made.messages().empty());
  CHECK(made.text == "* x.asc\nXU1 i o driver gain=2\nR1 a b 5\n.lib \"driver.lib\"\n.backanno\n.end\n");
}

TEST_CASE("a symbol without a prefix is the schematic of its name", "[unit]") {
  const Scratch scratch;
  write(scratch, "filter.asy",
        "Version 4\nSymbolType BLOCK\nPIN 0 0 LEFT 8\nPINATTR PinName in\nPINATTR SpiceOrder 1\nPIN 64 0 RIGHT 8\nPINATTR PinName "
        "out\nPINATTR "
        "SpiceOrder 2\n");
  write(scratch, "filter.asc",
        "Version 4\nWIRE 96 16 200 16\nFLAG 16 16 in\nFLAG 200 16 out\nFLAG 200 80 0\nSYMBOL res 112 0 R90\nSYMATTR InstName R1\nSYMATTR "
        "Value {R}\n"
        "SYMBOL cap 184 16 R0\nSYMATTR InstName C1\nSYMATTR Value 1n\nTEXT 0 0 Left 2 !.param R=1k\\n.tran 5m\n");
  const Made made(
      "Version 4\nFLAG 0 0 a\nFLAG 64 0 b\nSYMBOL filter 0 0 R0\nSYMATTR InstName F1\nSYMATTR SpiceLine R=2k\nTEXT 0 0 Left 2 !.tran 1m\n",
      scratch.path());
  CHECK(made.messages().empty());
  CHECK(made.text ==
        "* x.asc\nXF1 a b filter R=2k\n.subckt filter in out\nR1 out in {R}\nC1 out 0 1n\n.param R=1k\n.ends filter\n.tran "
        "1m\n.backanno\n.end\n");
}

TEST_CASE("what is wrong with a schematic is told with its place", "[unit]") {
  CHECK(Made("PADS-ASCII\n").messages() == "E-schematic «PADS-ASCII»\n");
  CHECK(Made("").messages() == "E-schematic «»\n");
  CHECK(Made("Version 4\nWIRE 1 2 3\n").messages() == "E-schematic-line «WIRE 1 2 3»\n");
  CHECK(Made("Version 4\nWIRE 1 2 3 999999999999\n").messages() == "E-schematic-line «WIRE 1 2 3 999999999999»\n");
  CHECK(Made("Version 4\nSYMATTR InstName R1\n").messages() == "E-schematic-line «SYMATTR InstName R1»\n");
  CHECK(Made("Version 4\nSYMBOL res 0 0 R45\n").messages() == "E-schematic-line «SYMBOL res 0 0 R45»\n");
  CHECK(Made("Version 4\nHOLOGRAM 1 2\n").messages() == "W-schematic-line «HOLOGRAM»\n");
  CHECK(Made("Version 4\nSYMBOL ress 0 0 R0\nSYMATTR InstName R1\n").messages() == "E-schematic-symbol «ress»\n");
  CHECK(Made("Version 4\nSYMBOL res 0 0 R0\n").messages() == "E-schematic-name «res»\n");
}

TEST_CASE("messages about a schematic's netlist name its lines", "[unit]") {
  SourceStore sources;
  Diagnostics diagnostics;
  static_cast<void>(netlist::parse(
      "x.asc", "Version 4\nSYMBOL res 0 0 R0\nSYMATTR InstName R1\nSYMATTR Value {1+}\nTEXT 0 0 Left 2 !.tran 1m\\n.param a={2*}\n",
      sources, diagnostics));
  REQUIRE(diagnostics.all().size() == 2);
  CHECK(render(diagnostics.all()[0], sources).starts_with("x.asc:2:8: error[E-syntax-expression]"));
  CHECK(render(diagnostics.all()[1], sources).starts_with("x.asc:5:40: error[E-syntax-expression]"));
}

TEST_CASE("a schematic in UTF-16, as LTspice writes some", "[unit]") {
  const std::string plain = "Version 4\r\nFLAG 16 16 a\r\nFLAG 16 96 0\r\nSYMBOL res 0 0 R0\r\nSYMATTR InstName R1\r\nSYMATTR Value 5\r\n";
  std::string wide;
  for (const char c : plain) wide += std::string{c, '\0'};
  for (const std::string& bytes : {wide, "\xFF\xFE" + wide}) {
    SourceStore sources;
    Diagnostics diagnostics;
    const netlist::Deck deck = netlist::parse("x.asc", bytes, sources, diagnostics);
    CHECK(diagnostics.all().empty());
    REQUIRE_FALSE(deck.cards.empty());
    CHECK(deck.cards.front().name == "R1");
  }
}

TEST_CASE("damaged schematics end in messages", "[property]") {
  for (unsigned seed = 1; seed <= 400; ++seed) {
    INFO("seed " << seed);
    std::mt19937 random(seed);
    std::string text = boost;
    for (unsigned change = random() % 20; change-- > 0;) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = static_cast<char>(random() % 256);
          break;
        case 1:
          text.erase(at, random() % 40);
          break;
        default:
          text.insert(at, text.substr(random() % text.size(), random() % 40));
      }
      if (text.empty()) text = "V";
    }
    SourceStore sources;
    Diagnostics diagnostics;
    const netlist::Deck deck = netlist::parse("x.asc", text, sources, diagnostics);
    for (const Diagnostic& diagnostic : diagnostics.all()) CHECK_FALSE(render(diagnostic, sources).empty());
  }
}

TEST_CASE("a symbol of the folder of amplifiers has five pins, where wires or labels end at all of them", "[unit]") {
  const std::string flags = "Version 4\nFLAG -32 80 p\nFLAG -32 48 n\nFLAG 0 32 vp\nFLAG 0 96 vn\n";
  const std::string symbol = "SYMBOL OpAmps\\\\LT1001 0 0 R0\nSYMATTR InstName U1\n";
  CHECK(Made(flags + "FLAG 32 64 out\n" + symbol).text.find("XU1 p n vp vn out LT1001\n") != std::string::npos);
  CHECK(Made(flags + symbol).messages() == "E-schematic-symbol «OpAmps\\\\LT1001»\n");
  const std::string comparator = "SYMBOL Comparators\\\\LT1116 0 0 R0\nSYMATTR InstName U1\n";
  CHECK(Made(flags + "FLAG 32 64 out\n" + comparator).text.find("XU1 p n vp vn out LT1116\n") != std::string::npos);
  CHECK(Made(flags + comparator).messages() == "E-schematic-symbol «Comparators\\\\LT1116»\n");
}

TEST_CASE("a comparator and a ferrite bead of LTspice's library", "[unit]") {
  // Pins as two schematics of others have them: in+ below in-, the supply in the middle; a bead's ends are 32 above and below its place.
  const Made made(
      "Version 4\nFLAG -32 80 p\nFLAG -32 48 n\nFLAG 0 32 vp\nFLAG 0 96 vn\nFLAG 32 64 out\nSYMBOL Comparators\\\\LT1720 0 0 R0\n"
      "SYMATTR InstName U1\nFLAG 240 32 a\nFLAG 304 32 b\nSYMBOL FerriteBead 272 32 R90\nSYMATTR InstName L1\nSYMATTR Value 17n\n");
  CHECK(made.messages().empty());
  CHECK(made.text.find("XU1 p n vp vn out LT1720\n") != std::string::npos);
  CHECK(made.text.find("L1 b a 17n\n") != std::string::npos);
}
