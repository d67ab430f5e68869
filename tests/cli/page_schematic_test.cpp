// The schematic on the page of --report: symbols at their pins, values at the cursor, conduction, traces by a click; in headless Chromium where that is
// installed.

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <set>

#include <fmt/format.h>

#include "base/source.hpp"
#include "cli/page.hpp"
#include "cli/run_in.hpp"
#include "cli/schematic_json.hpp"
#include "netlist/schematic/netlister.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

/// v(a) is a triangle from −2 V to 2 V and back within 4 s; D1 (no drop, 1 Ω) and 9 Ω behind it carry v(a)/10 while it is above zero: from 1 s to 3 s.
/// D2 breaks down beyond 1 V backwards: from 0 s to 0.5 s. Only v(a) is saved.
const std::string drawn_rectifier = R"(Version 4
SHEET 1 880 680
WIRE 96 96 0 96
WIRE 0 112 0 96
WIRE 160 96 240 96
FLAG 0 192 0
FLAG 0 96 a
FLAG 240 176 0
FLAG 0 320 a
FLAG 0 464 0
SYMBOL voltage 0 96 R0
SYMATTR InstName V1
SYMATTR Value PWL(0 -2 2 2 4 -2)
SYMBOL diode 96 112 R270
SYMATTR InstName D1
SYMATTR Value DI
SYMBOL res 224 80 R0
SYMATTR InstName R1
SYMATTR Value 9
SYMBOL zener -16 320 R0
SYMATTR InstName D2
SYMATTR Value DZ
SYMBOL res -16 368 R0
SYMATTR InstName R2
SYMATTR Value 1
TEXT 0 520 Left 2 !.model DI D(Ron=1)\n.model DZ D(Ron=1 Vfwd=10 Vrev=1 Rrev=1)\n.tran 0.01 4\n.save V(a)
)";

struct Reported {
  const Scratch scratch;
  explicit Reported(const std::string& schematic, const std::string& name = "s.asc") {
    scratch.write(name, schematic);
    REQUIRE(run_in(scratch, {name, "--report", "r.html"}).status == 0);
  }
  [[nodiscard]] std::string page() const { return read_file(scratch / "r.html"); }
};

/// What the tests' scripts use: a part by its name, the line of its current, that of a net's voltage.
const std::string helpers =
    "const parts = () => JSON.parse(byId('run').textContent).schematic.sheets[0].parts;"
    "const part = name => document.querySelectorAll('#schematic .part')[parts().findIndex(each => each.name === name)];"
    "const current = name => part(name).querySelector('.current').textContent;"
    "const net = label => [...document.querySelectorAll('#schematic .net')].find(each => each.querySelector('.label')?.textContent === "
    "label);"
    "const at = share => clickAt(plotArea(0), [share, 0.5]);";

/// All symbols of lib/ltspice.symbols in all orientations, far apart.
std::string every_symbol() {
  std::string text = "Version 4\n";
  int row = 0;
  for (const std::string& name : netlist::standard_symbol_names()) {
    for (int k = 0; k < 8; ++k)
      text += fmt::format("SYMBOL {} {} {} {}{}\nSYMATTR InstName X{}\nSYMATTR Value v\n", name, 640 * k, 640 * row, k < 4 ? 'R' : 'M',
                          90 * (k % 4), 8 * row + k);
    ++row;
  }
  return text;
}

std::string drawn_json(const std::string& schematic) {
  SourceStore sources;
  Diagnostics diagnostics;
  netlist::Drawing drawing;
  static_cast<void>(netlist::netlist_of(sources.add("x.asc", schematic), "/nowhere", sources, diagnostics, &drawing));
  CHECK(diagnostics.all().empty());
  return cli::schematic_json(drawing, netlist::places_of(drawing));
}

}  // namespace

TEST_CASE("the page has the signals of all that is drawn, whatever is saved, and rows have those saved", "[unit]") {
  const Reported reported(drawn_rectifier);
  CHECK(read_file(reported.scratch / "s.csv").substr(0, 10) == "time,V(a)\n");
  const Json data = data_of(reported.page());
  CHECK(data["saved"].number == 1.0);
  std::set<std::string> names;
  for (const Json& signal : data["signals"].array) names.insert(signal["name"].string);
  CHECK(names == std::set<std::string>{"V(a)", "v(N001)", "v(N002)", "i(V1)", "i(D1)", "i(R1)", "i(D2)", "i(R2)"});
  CHECK(data["run"]["signals"].array.size() == 1);
  CHECK(data["schematic"]["sheets"].array.size() == 1);
}

TEST_CASE("the page of a netlist has no schematic, nor signals beyond those saved", "[unit]") {
  const Scratch scratch;
  scratch.write("d.net", "t\nV1 a 0 1\nR1 a 0 1\nC1 a 0 1u\n.save v(a)\n.tran 1m 2m\n");
  REQUIRE(run_in(scratch, {"d.net", "--report", "r.html"}).status == 0);
  const Json data = data_of(read_file(scratch / "r.html"));
  CHECK(data["schematic"].kind == Json::Kind::null);
  CHECK(data["signals"].array.size() == 1);
  const Json seen = played(scratch, "r.html", "seen.hidden = byId('schematic').hidden;");
  if (!seen.object.empty()) CHECK(seen["hidden"].truth);
}

TEST_CASE("a block's sheet has the signals of each place that calls it", "[unit]") {
  const Scratch scratch;
  const auto write = [&](const std::string& name, const std::string& text) { std::ofstream(scratch.path() / name) << text; };
  write("pair.asy",
        "Version 4\nSymbolType BLOCK\nRECTANGLE Normal -32 -32 32 32\nPIN -32 0 LEFT 8\nPINATTR PinName in\nPINATTR SpiceOrder 1\n");
  write("pair.asc",
        "Version 4\nFLAG 16 16 in\nFLAG 16 176 0\nSYMBOL res 0 0 R0\nSYMATTR InstName R1\nSYMATTR Value 3\nSYMBOL res 0 80 R0\nSYMATTR "
        "InstName R2\nSYMATTR Value 1\n");
  scratch.write(
      "s.asc",
      "Version 4\nWIRE 0 16 64 16\nFLAG 0 96 0\nFLAG 64 16 a\nFLAG 200 0 a\nSYMBOL voltage 0 0 R0\nSYMATTR InstName V1\nSYMATTR Value 8\n"
      "SYMBOL pair 96 16 R0\nSYMATTR InstName X1\nSYMBOL pair 232 0 R0\nSYMATTR InstName U2\nTEXT 0 200 Left 2 !.tran 1m 2m\n");
  REQUIRE(run_in(scratch, {"s.asc", "--report", "r.html"}).status == 0);
  const Json data = data_of(read_file(scratch / "r.html"));
  REQUIRE(data["schematic"]["places"].array.size() == 3);
  const Json seen =
      played(scratch, "r.html",
             "byId('schematic-place').value = 2; byId('schematic-place').onchange(); await wait(60);"
             "seen.currents = [...document.querySelectorAll('#schematic .current')].map(text => text.textContent).join();"
             "seen.voltages = [...document.querySelectorAll('#schematic .voltage')].map(text => text.textContent).join();"
             "byId('schematic-place').value = 0; byId('schematic-place').onchange(); await wait(60);"
             "document.querySelectorAll('#schematic .part')[1].dispatchEvent(new MouseEvent('click', {bubbles: true})); await wait(60);"
             "seen.place = byId('schematic-place').selectedOptions[0].textContent;");
  if (seen.object.empty()) return;
  CHECK(seen["currents"].string == "2 A,2 A");  // 8 V at 3 Ω + 1 Ω
  CHECK_THAT(seen["voltages"].string, Contains("8 V"));
  CHECK(seen["place"].string == "X1");
}

TEST_CASE("symbols of all kinds and orientations are drawn to their pins, and texts stand upright", "[unit]") {
  const Reported reported(drawn_rectifier);
  std::string page = reported.page();
  const std::string key = "\"schematic\": ";
  const std::size_t begin = page.find(key) + key.size(), end = page.find(", \"ports\"", begin);
  REQUIRE(end != std::string::npos);
  page.replace(begin, end - begin, drawn_json(every_symbol()));
  reported.scratch.write("all.html", page);
  const Json seen = played(
      reported.scratch, "all.html",
      "const sheet = JSON.parse(byId('run').textContent).schematic.sheets[0], groups = document.querySelectorAll('#schematic .part');"
      "const missed = [], reach = 3;"
      "sheet.parts.forEach((part, k) => {"
      "  const symbol = groups[k].querySelector('.symbol'), box = symbol.transform.baseVal.consolidate().matrix.inverse();"
      "  for (const [x, y] of part.terminals) {"
      "    const point = new DOMPoint(x, y).matrixTransform(box);"
      "    const isMet = [...symbol.querySelectorAll('path')].some(path => { path.style.strokeWidth = 2 * reach;"
      "      return path.isPointInStroke(point); });"
      "    if (!isMet) missed.push(part.symbol + ' ' + part.mirrored + part.quarters + ' ' + x + ',' + y);"
      "  }"
      "});"
      "seen.missed = missed.slice(0, 20).join('; '); seen.parts = groups.length;"
      "seen.turned = [...document.querySelectorAll('#schematic .symbol text, #schematic text[transform]')].length;");
  if (seen.object.empty()) return;
  CHECK(seen["missed"].string == "");
  CHECK(seen["parts"].number == 8.0 * static_cast<double>(netlist::standard_symbol_names().size()));
  CHECK(seen["turned"].number == 0.0);
}

TEST_CASE("voltages and currents, arrows and conduction follow the cursor", "[unit]") {
  const Reported reported(drawn_rectifier);
  const Json seen = played(
      reported.scratch, "r.html",
      helpers +
          "const look = name => ({d1: part('D1').dataset.state, d2: part('D2').dataset.state, r1: current('R1'), d2i: current('D2'),"
          "  a: net('a').querySelector('.voltage').textContent, arrow: part('R2').querySelector('.arrow').getAttribute('transform')});"
          "await at(0.0625); seen.early = look();"
          "await at(0.375); seen.later = look(); seen.time = byId('schematic-time').textContent;"
          "const slider = byId('schematic-slider'); slider.value = 500; slider.oninput({target: slider}); seen.middle "
          "= "
          "look();");
  if (seen.object.empty()) return;
  // At 0.25 s v(a) = −1.5 V: D1 blocks; D2 carries (1.5 V − 1 V) over 1 Ω + 1 Ω backwards. At 1.5 s v(a) = 1 V, over 10 Ω. At 2 s it is 2 V.
  CHECK(seen["early"]["d1"].string == "blocking");
  CHECK(seen["early"]["d2"].string == "breakdown");
  CHECK(seen["early"]["r1"].string == "0 A");
  CHECK(std::stod(seen["early"]["d2i"].string) == Approx(-250.0).margin(15.0));  // mA, a click is as exact as a pixel
  CHECK(std::stod(seen["early"]["a"].string) == Approx(-1.5).margin(0.03));
  CHECK_THAT(seen["early"]["arrow"].string, Contains("rotate(270)"));  // upwards, against the direction from its first pin to its second
  CHECK(seen["later"]["d1"].string == "conducting");
  CHECK(seen["later"]["d2"].string == "blocking");
  CHECK(std::stod(seen["later"]["r1"].string) == Approx(100.0).margin(3.0));
  CHECK_THAT(seen["time"].string, Contains("cursor A"));
  CHECK(seen["middle"]["a"].string == "2 V");
  CHECK(seen["middle"]["r1"].string == "200 mA");
}

TEST_CASE("the pointer on a net or symbol makes other curves pale, a click adds its trace and removes it", "[unit]") {
  const Reported reported(drawn_rectifier);
  const Json seen =
      played(reported.scratch, "r.html",
             helpers +
                 "const click = group => { group.dispatchEvent(new MouseEvent('click', {bubbles: true})); };"
                 "seen.first = byId('trace-count').textContent;"
                 "click(part('R1')); await wait(60); seen.added = view().traces;"
                 "click(part('D2')); await wait(60);"
                 "part('R1').dispatchEvent(new PointerEvent('pointerenter')); await wait(60);"
                 "seen.pale = [...document.querySelectorAll('.u-series')].filter(row => Number(row.style.opacity || 1) < 1)"
                 "  .map(row => row.querySelector('.u-label').textContent).join();"
                 "part('R1').dispatchEvent(new PointerEvent('pointerleave')); await wait(60);"
                 "part('R1').dispatchEvent(new KeyboardEvent('keydown', {key: 'Enter', bubbles: true})); click(part('D2')); await wait(60);"
                 "seen.removed = view().traces ?? 'none kept';"
                 "click(net('a')); await wait(60); seen.net = byId('trace-count').textContent;");
  if (seen.object.empty()) return;
  CHECK_THAT(seen["first"].string, Contains("1 of 8"));
  CHECK(seen["added"].string == "V(a);i(R1)");
  CHECK(seen["pale"].string == "i(D2)");
  CHECK(seen["removed"].string == "none kept");
  CHECK_THAT(seen["net"].string, Contains("0 of 8"));
}

TEST_CASE("the schematic is saved as it stands", "[unit]") {
  const Reported reported(drawn_rectifier);
  const Json seen = played(reported.scratch, "r.html",
                           helpers +
                               "await at(0.375); const [name, text] = saved('schematic-svg'); seen.name = name;"
                               "const file = new DOMParser().parseFromString(text, 'image/svg+xml');"
                               "seen.problem = file.querySelector('parsererror')?.textContent ?? '';"
                               "seen.texts = [...file.querySelectorAll('text')].map(each => each.textContent).join('|');"
                               "seen.unstyled = [...file.querySelectorAll('path, text')].filter(each => "
                               "!/^(rgb|none)/.test(each.getAttribute('fill'))).length;");
  if (seen.object.empty()) return;
  CHECK(seen["name"].string == "s-schematic.svg");
  CHECK(seen["problem"].string == "");
  CHECK(seen["unstyled"].number == 0.0);
  CHECK_THAT(seen["texts"].string, Contains("D1|DI") && Contains("R1|9"));
}

TEST_CASE("the schematic can be read in both modes and fits a phone", "[unit]") {
  for (const Window window : {Window{1200, false}, Window{1200, true}, Window{390, false}}) {
    INFO(window.width << " pixels, dark: " << window.is_dark);
    const Reported reported(drawn_rectifier);
    const Json seen =
        played(reported.scratch, "r.html",
               helpers +
                   "await at(0.375);"
                   "seen.pale = paleTexts().join('; '); seen.unnamed = unnamed().join('; ');"
                   "seen.outside = [...document.body.querySelectorAll('*')].filter(box => !box.closest('.scroll') && "
                   "box.getBoundingClientRect().right > innerWidth + 0.5).map(box => box.outerHTML.slice(0, 60)).join('; ');"
                   "const boxes = [...document.querySelectorAll('#schematic svg text')].map(text => text.getBoundingClientRect());"
                   "seen.covered = boxes.filter((a, k) => boxes.some((b, j) => j > k && a.left < b.right - 1 && b.left < a.right - 1 && "
                   "a.top < b.bottom - 4 && b.top < a.bottom - 4)).length;",
               "", window);
    if (seen.object.empty()) return;
    CHECK(seen["pale"].string == "");
    CHECK(seen["unnamed"].string == "");
    CHECK(seen["outside"].string == "");
    CHECK(seen["covered"].number == 0.0);
  }
}

TEST_CASE("a schematic with more signals than a page holds says so", "[unit]") {
  std::string text =
      "Version 4\nFLAG 0 16 a\nFLAG 0 96 0\nSYMBOL voltage 0 0 R0\nSYMATTR InstName V1\nSYMATTR Value 1\nTEXT 0 200 Left 2 !.tran 1m 2m\n";
  constexpr int resistors = 210;
  for (int k = 0; k < resistors; ++k)
    text += fmt::format("FLAG {0} 16 a\nFLAG {0} 96 0\nSYMBOL res {1} 0 R0\nSYMATTR InstName R{2}\nSYMATTR Value 1k\n", 96 * k + 116,
                        96 * k + 100, k);
  const Reported reported(text);
  const Json seen =
      played(reported.scratch, "r.html",
             "seen.legend = byId('schematic-legend').textContent; seen.shown = document.querySelectorAll('#schematic .current').length;");
  if (seen.object.empty()) return;
  CHECK_THAT(seen["legend"].string, Contains("200 signals"));
  CHECK(seen["shown"].number == 199.0);  // besides v(a)
}

TEST_CASE("where a long run has only bins, the schematic says that it shows means", "[unit]") {
  std::string text = drawn_rectifier;
  const std::string source = "PWL(0 -2 2 2 4 -2)";
  text.replace(text.find(source), source.size(), "SIN(0 2 2k)");
  const Reported reported(text);
  const Json data = data_of(reported.page());
  REQUIRE(data["thinned"].truth);
  const Json seen = played(reported.scratch, "r.html",
                           helpers + "await at(0.1); seen.time = byId('schematic-time').textContent; seen.r1 = current('R1');");
  if (seen.object.empty()) return;
  CHECK_THAT(seen["time"].string, Contains("means"));
  // A sine of 2 V, rectified by half, over 10 Ω: 2 V/π/10 Ω = 63.66 mA.
  CHECK(std::stod(seen["r1"].string) == Approx(63.66).epsilon(1e-3));
}
