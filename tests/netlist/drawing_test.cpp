// What a picture of a schematic needs: places on the sheet, nets and dots beside the netlist, names of the flat circuit.

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "netlist/schematic/netlister.hpp"
#include "support/scratch.hpp"

namespace {

using namespace pwlsim;
using netlist::DrawnSheet;
using netlist::GridPoint;
using netlist::Wire;
using test::Scratch;

/// The drawing of a schematic in memory, and its netlist.
struct Drawn {
  netlist::Drawing drawing;
  std::string text;
  std::size_t messages = 0;

  explicit Drawn(const std::string& schematic, const std::filesystem::path& folder = "/nowhere") {
    SourceStore sources;
    Diagnostics diagnostics;
    const FileIndex file = sources.add("x.asc", schematic);
    text = netlist::netlist_of(file, folder, sources, diagnostics, &drawing).text;
    messages = diagnostics.all().size();
  }
};

/// Nodes of the cards by name of the element: what stands between the name and the last word.
std::map<std::string, std::vector<std::string>> nodes_of(const std::string& netlist) {
  std::map<std::string, std::vector<std::string>> nodes;
  std::istringstream lines(netlist);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::vector<std::string> all;
    for (std::string word; words >> word;) all.push_back(word);
    if (all.size() > 2 && all.front().front() == 'R' && !all.front().starts_with("R_label"))
      nodes[all.front()] = {all.begin() + 1, all.end() - 1};
  }
  return nodes;
}

/// Sets of places that a reader of the picture sees connected: along wires, where labels lie on them, and where there is a dot.
class ByEye {
 public:
  explicit ByEye(const DrawnSheet& sheet) {
    for (const DrawnSheet::Line& line : sheet.wires) join(line.wire.from, line.wire.to);
    const auto join_at = [&](GridPoint point) {
      for (const DrawnSheet::Line& line : sheet.wires)
        if (netlist::lies_on(point, line.wire)) join(point, line.wire.from);
    };
    for (const GridPoint dot : sheet.dots) join_at(dot);
    std::map<std::string, GridPoint> labels;
    for (const DrawnSheet::Label& label : sheet.labels) {
      join_at(label.flag.at);
      join(label.flag.at, labels.emplace(label.flag.name, label.flag.at).first->second);
    }
  }
  GridPoint root(GridPoint point) {
    while (parents_.contains(point) && parents_[point] != point) point = parents_[point];
    return point;
  }

 private:
  void join(GridPoint a, GridPoint b) { parents_[root(a)] = root(b); }
  std::map<GridPoint, GridPoint> parents_;
};

/// Wires on a small grid, so that they often touch and cross; resistors in all orientations; a few labels.
std::string random_sheet(unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](unsigned n) { return static_cast<int>(random() % n); };
  const auto place = [&] { return GridPoint{16 * below(12), 16 * below(12)}; };
  std::string text = "Version 4\n";
  for (int k = 0; k < 14; ++k) {
    const GridPoint from = place();
    GridPoint to = place();
    (below(2) == 0 ? to.x : to.y) = below(2) == 0 ? from.x : from.y;
    if (to.x != from.x) to.y = from.y;
    if (to != from) text += fmt::format("WIRE {} {} {} {}\n", from.x, from.y, to.x, to.y);
  }
  constexpr std::array<const char*, 3> names{"0", "a", "b"};
  for (int k = 0; k < 4; ++k) {
    const GridPoint at = place();
    text += fmt::format("FLAG {} {} {}\n", at.x, at.y, names.at(random() % names.size()));
  }
  for (int k = 0; k < 5; ++k) {
    const GridPoint at = place();
    text += fmt::format("SYMBOL res {} {} {}{}\nSYMATTR InstName R{}\nSYMATTR Value 1\n", at.x, at.y, below(2) == 0 ? 'R' : 'M',
                        90 * below(4), k);
  }
  return text;
}

}  // namespace

TEST_CASE("what a reader sees connected is connected in the netlist, and nothing else", "[property]") {
  for (unsigned seed = 1; seed <= 500; ++seed) {
    INFO("seed " << seed);
    const Drawn drawn(random_sheet(seed));
    REQUIRE(drawn.drawing.size() == 1);
    const DrawnSheet& sheet = drawn.drawing.front();
    ByEye eye(sheet);
    std::map<GridPoint, int> nets;  // of sets
    std::map<int, GridPoint> sets;  // of nets
    const auto check = [&](GridPoint at, int net) {
      const GridPoint root = eye.root(at);
      CHECK(nets.emplace(root, net).first->second == net);
      CHECK(sets.emplace(net, root).first->second == root);
    };
    for (const DrawnSheet::Line& line : sheet.wires) check(line.wire.from, line.net);
    for (const DrawnSheet::Label& label : sheet.labels) check(label.flag.at, label.net);
    const auto cards = nodes_of(drawn.text);
    for (const DrawnSheet::DrawnPart& part : sheet.parts) {
      const std::vector<std::string>& nodes = cards.at(part.element);
      REQUIRE(part.terminals.size() == nodes.size());
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        check(part.terminals[k].at, part.terminals[k].net);
        CHECK(sheet.nets[static_cast<std::size_t>(part.terminals[k].net)] == nodes[k]);
      }
    }
  }
}

TEST_CASE("terminals of a schematic that LTspice drew lie at the ends of its wires and labels", "[unit]") {
  std::ifstream file(std::string(PWLSIM_SOURCE_DIR) + "/netlists/boost_schematic.asc");
  std::ostringstream text;
  text << file.rdbuf();
  const Drawn drawn(text.str());
  const DrawnSheet& sheet = drawn.drawing.at(0);
  std::set<GridPoint> ends;
  for (const DrawnSheet::Line& line : sheet.wires) ends.insert({line.wire.from, line.wire.to});
  for (const DrawnSheet::Label& label : sheet.labels) ends.insert(label.flag.at);
  CHECK(sheet.parts.size() == 7);
  for (const DrawnSheet::DrawnPart& part : sheet.parts)
    for (const DrawnSheet::Terminal& terminal : part.terminals) {
      INFO(part.name << " at " << terminal.at.x << ", " << terminal.at.y);
      CHECK(ends.contains(terminal.at));
    }
  // Three ways meet at the drain and at the output, where C1 and R1 are joined; crossings of the file: none.
  CHECK(sheet.dots == std::vector<GridPoint>{{256, 96}, {480, 96}});
  CHECK(sheet.parts[1].name == "L1");
  CHECK(sheet.parts[1].symbol == "ind");
  CHECK(sheet.parts[1].value == "100µ");
  CHECK(sheet.parts[1].orientation.quarters == 3);
}

TEST_CASE("sheets of blocks have the names of the flat circuit at each place", "[unit]") {
  const Scratch scratch;
  const auto write = [&](const std::string& name, const std::string& text) { std::ofstream(scratch.path() / name) << text; };
  const std::string wires =
      "PIN -32 0 LEFT 8\nPINATTR PinName in\nPINATTR SpiceOrder 1\nPIN 32 0 NONE 0\nPINATTR PinName out\nPINATTR SpiceOrder 2\n";
  write("inner.asy", "Version 4\nSymbolType BLOCK\nRECTANGLE Normal -32 -16 32 16\nLINE Normal -32 -16 32 16 2\n" + wires);
  write("inner.asc", "Version 4\nWIRE 16 96 96 96\nFLAG 16 16 in\nFLAG 96 96 out\nFLAG 0 0 Vcc\nSYMBOL res 0 0 R0\nSYMATTR InstName R1\n");
  write("outer.asy", "Version 4\nSymbolType BLOCK\n" + wires);
  write("outer.asc",
        "Version 4\nWIRE 32 0 96 0\nFLAG -32 0 in\nFLAG 160 0 out\nSYMBOL inner 0 0 R0\nSYMATTR InstName X1\nSYMBOL inner 128 0 "
        "R0\nSYMATTR InstName U2\n");
  const Drawn drawn(
      "Version 4\nFLAG -32 0 a\nFLAG 32 0 b\nFLAG 200 0 K\nSYMBOL outer 0 0 R0\nSYMATTR InstName X3\nTEXT 8 40 Left 2 !.tran 1\\nK1 L1 L2 "
      "1\nTEXT 8 90 Left 2 !.global x VCC\n",
      scratch.path());
  CHECK(drawn.messages == 0);
  REQUIRE(drawn.drawing.size() == 3);
  const auto places = netlist::places_of(drawn.drawing);
  REQUIRE(places.size() == 4);
  const auto node = [&](std::size_t place, const std::string& net) {
    const auto& nets = drawn.drawing[places[place].sheet].nets;
    return places[place].nodes.at(static_cast<std::size_t>(std::find(nets.begin(), nets.end(), net) - nets.begin()));
  };
  CHECK(places[0].path.empty());
  CHECK(places[1].path == "X3");
  CHECK(node(1, "in") == "a");
  CHECK(node(1, "N001") == "X3.N001");
  CHECK(places[2].path == "X3.X1");
  CHECK(places[2].elements == std::vector<std::string>{"X3.X1.R1"});
  CHECK(node(2, "out") == "X3.N001");
  CHECK(places[3].path == "X3.XU2");
  CHECK(node(3, "in") == "X3.N001");
  CHECK(node(3, "out") == "b");
  CHECK(node(3, "Vcc") == "Vcc");
  const DrawnSheet::DrawnPart& inner = drawn.drawing[places[1].sheet].parts.front();
  REQUIRE(inner.strokes.size() == 2);
  CHECK(inner.strokes[0].kind == netlist::Stroke::Kind::rectangle);
  CHECK(inner.strokes[1].points == std::vector<GridPoint>{{-32, -16}, {32, 16}});
  CHECK(inner.terminals[0].name == "in");
  CHECK(inner.terminals[1].name.empty());  // its file says that it does not show
  REQUIRE(drawn.drawing[0].couplings.size() == 1);
  CHECK(drawn.drawing[0].couplings[0].text == "K1 L1 L2 1");
}
