// The page of --report in use: mouse, fingers, keys, files, spectrum, x–y plot, contrast and labels, in headless Chromium where that is installed.

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <sstream>

#include "cli/page.hpp"
#include "cli/run_in.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

/// v(a) is a triangle from 0 to 2 V and back within 2 s; i(R1) a thousandth of it; D2 conducts while v(a) is above 1 V: from 0.5 s to 1.5 s.
const std::string triangle =
    "triangle\nV1 a 0 PWL(0 0 1 2 2 0)\nR1 a 0 1k\nR2 a b 1\n.model DI D\n.tran 0.01 2\n.save v(a) i(R1) i(D2)\nD2 b d DI\nV3 d 0 1\n";
constexpr int phone = 390;  ///< pixels of width

double number(const Json& text) { return std::stod(text.string); }

/// The report of a deck, used by a script.
Json used(const std::string& deck, const std::string& script, const std::string& view = "", Window window = {}) {
  const Scratch scratch;
  scratch.write("d.net", deck);
  REQUIRE(run_in(scratch, {"d.net", "--report", "r.html"}).status == 0);
  return played(scratch, "r.html", script, view, window);
}

/// As a user sees it after opening everything that is folded.
const std::string open_all = "for (const box of document.querySelectorAll('details')) box.open = true; await wait(300);";

constexpr double pixel = 0.005;  ///< of a plot's width and height

}  // namespace

TEST_CASE("a box zooms time and values, shift-drag moves, the wheel zooms, a double-click shows all", "[unit]") {
  const Json seen = used(
      triangle,
      "const area = plotArea(0);"
      "await drag(area, [0.25, 0.25], [0.5, 0.75]); seen.box = view();"
      "await drag(area, [0.5, 0.5], [0.25, 0.5], {shiftKey: true}); seen.moved = view();"
      "area.dispatchEvent(new MouseEvent('dblclick', {bubbles: true})); await wait(30); seen.whole = view();"
      "await drag(area, [0.25, 0.5], [0.75, 0.51]); seen.flat = view();"
      "const box = area.getBoundingClientRect(), wheel = more => area.dispatchEvent(new WheelEvent('wheel', {bubbles: true, cancelable: "
      "true, deltaY: -1, clientX: box.left, clientY: box.bottom, ...more}));"
      "wheel({}); seen.wheel = view(); wheel({shiftKey: true}); seen.values = view();",
      "#y=0:0:2");
  if (seen.object.empty()) return;
  // A quarter of 2 s to a half; a quarter of 2 V from the top to three quarters.
  const auto window = [&](const char* name, double from, double to) {
    INFO(name);
    CHECK(number(seen[name]["from"]) == Approx(from).margin(2 * pixel));
    CHECK(number(seen[name]["to"]) == Approx(to).margin(2 * pixel));
  };
  const auto values = [&](const char* name, double low, double high) {
    const std::string text = seen[name]["y"].string;
    REQUIRE(text.substr(0, 2) == "0:");
    CHECK(std::stod(text.substr(2)) == Approx(low).margin(2 * pixel));
    CHECK(std::stod(text.substr(text.rfind(':') + 1)) == Approx(high).margin(2 * pixel));
  };
  window("box", 0.5, 1.0);
  values("box", 0.5, 1.5);
  window("moved", 0.625, 1.125);
  CHECK(seen["whole"].object.empty());
  window("flat", 0.5, 1.5);
  CHECK(seen["flat"].object.count("y") == 0);
  window("wheel", 0.5, 1.3);  // 0.8 of it about its left end
  CHECK(seen["values"].object.count("y") == 1);
}

TEST_CASE("cursors snap to events and can be dragged", "[unit]") {
  const Json seen = used(triangle,
                         "const area = plotArea(0);"
                         "await clickAt(area, [0.2505, 0.5]); seen.clicked = view();"
                         "await clickAt(area, [0.4, 0.5], {shiftKey: true}); seen.second = view();"
                         "await drag(area, [0.2505, 0.5], [0.7495, 0.5]); seen.dragged = view();");
  if (seen.object.empty()) return;
  // D2 begins to conduct at 0.5 s and ends at 1.5 s.
  CHECK(number(seen["clicked"]["A"]) == Approx(0.5).epsilon(1e-12));
  CHECK(number(seen["second"]["B"]) == Approx(0.8).margin(2 * pixel));
  CHECK(number(seen["dragged"]["A"]) == Approx(1.5).epsilon(1e-12));
  CHECK(seen["dragged"].object.count("from") == 0);
}

TEST_CASE("fingers at 390 pixels: two zoom, one moves, a tap and a long tap set the cursors; nothing sticks out", "[unit]") {
  const Json seen =
      used(triangle,
           "const area = plotArea(0), finger = id => ({pointerType: 'touch', pointerId: id});"
           "seen.width = innerWidth;"
           "send(area, 'pointerdown', [0.25, 0.5], finger(1)); send(area, 'pointerdown', [0.75, 0.5], finger(2));"
           "send(area, 'pointermove', [0, 0.5], finger(1)); send(area, 'pointermove', [1, 0.5], finger(2)); await wait(60);"
           "send(area, 'pointerup', [0, 0.5], finger(1)); send(area, 'pointerup', [1, 0.5], finger(2)); await wait(60);"
           "seen.pinched = view();"
           "await drag(area, [0.75, 0.5], [0.5, 0.5], finger(1)); seen.moved = view();"
           "byId('whole').click(); await clickAt(area, [0.25, 0.5], finger(1));"
           "send(area, 'pointerdown', [0.6, 0.5], finger(1)); await wait(700); send(area, 'pointerup', [0.6, 0.5], finger(1));"
           "await wait(30); seen.taps = view();" +
               open_all +
               "seen.outside = [...document.body.querySelectorAll('*')].filter(box => !box.closest('.scroll') && "
               "box.getBoundingClientRect().right > "
               "innerWidth).map(box => box.outerHTML.slice(0, 60)).join('; ');"
               "seen.small = [...document.querySelectorAll('.bar button')].filter(box => isShown(box) && box.getBoundingClientRect().height < 24).length;"
               "seen.plot = plotArea(0).clientWidth;",
           "", {phone});
  if (seen.object.empty()) return;
  REQUIRE(seen["width"].number == 390.0);
  // The times under the fingers, 0.5 s and 1.5 s, go to the edges.
  CHECK(number(seen["pinched"]["from"]) == Approx(0.5).margin(4 * pixel));
  CHECK(number(seen["pinched"]["to"]) == Approx(1.5).margin(4 * pixel));
  CHECK(number(seen["moved"]["from"]) == Approx(0.75).margin(4 * pixel));
  CHECK(number(seen["taps"]["A"]) == Approx(0.5).margin(4 * pixel));
  CHECK(number(seen["taps"]["B"]) == Approx(1.2).margin(4 * pixel));
  CHECK(seen["outside"].string == "");
  CHECK(seen["small"].number == 0.0);
  CHECK(seen["plot"].number > 250.0);
}

TEST_CASE("keys move, zoom and step from event to event", "[unit]") {
  const Json seen =
      used(triangle,
           "await press('+'); seen.in = view(); await press('ArrowRight'); seen.right = view(); await press('ArrowLeft');"
           "await press('-'); seen.out = view(); await press('n'); seen.next = view();"
           "await press('n'); await press('n'); await press('p'); seen.previous = view(); await press('N'); seen.second = view();"
           "await press('Escape'); seen.none = view();"
           "byId('trace-search').dispatchEvent(new KeyboardEvent('keydown', {key: '+', bubbles: true})); seen.typed = view();");
  if (seen.object.empty()) return;
  CHECK(seen["in"]["from"].string == "0.5");
  CHECK(seen["in"]["to"].string == "1.5");
  CHECK(seen["right"]["from"].string == "0.75");
  CHECK(seen["out"].object.empty());
  // Events: D2 on at 0.5 s and off at 1.5 s; there is none after it.
  CHECK(number(seen["next"]["A"]) == Approx(0.5));
  CHECK(number(seen["previous"]["A"]) == Approx(0.5));
  CHECK(number(seen["second"]["B"]) == Approx(0.5));
  CHECK(seen["none"].object.empty());
  CHECK(seen["typed"].object.empty());
}

TEST_CASE("the view is saved as CSV, SVG and PNG", "[unit]") {
  const Json seen =
      used(triangle,
           "[seen.csvName, seen.csv] = saved('csv'); seen.csv = seen.csv.split(String.fromCharCode(10)).join(';'); let text; "
           "[seen.svgName, text] = saved('svg');"
           "const svg = new DOMParser().parseFromString(text, 'image/svg+xml');"
           "seen.svgFault = svg.querySelector('parsererror')?.textContent ?? '';"
           "seen.names = [...svg.querySelectorAll('text')].map(each => each.textContent).join(' ');"
           "seen.curves = svg.querySelectorAll('polyline').length;"
           "let bytes; [seen.pngName, bytes] = saved('png'); const number = place => new DataView(bytes.buffer).getUint32(place);"
           "seen.signature = number(0) === 0x89504e47; seen.png = [number(16), number(20)]; seen.bytes = bytes.length;",
           "#from=0.25&to=1.75");
  if (seen.object.empty()) return;
  CHECK(seen["csvName"].string == "d-view.csv");
  CHECK(seen["svgName"].string == "d-view.svg");
  CHECK(seen["pngName"].string == "d-view.png");
  std::istringstream lines(seen["csv"].string);
  std::string line;
  std::getline(lines, line, ';');
  CHECK(line == "time,v(a),i(R1),i(D2)");
  std::size_t count = 0;
  for (; std::getline(lines, line, ';'); ++count) {
    double t = 0.0, v = 0.0, r = 0.0, d = 0.0;
    REQUIRE(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &t, &v, &r, &d) == 4);
    const double expected = 2.0 - 2.0 * std::abs(1.0 - t);
    CHECK(v == Approx(expected).margin(1e-12));
    CHECK(r == Approx(1e-3 * expected).margin(1e-14));
    CHECK(d == Approx(std::max(expected - 1.0, 0.0)).margin(1e-12));  // over 1 Ω
  }
  CHECK(count > 100);
  CHECK(seen["svgFault"].string.empty());
  CHECK(seen["curves"].number == 3.0);
  CHECK_THAT(seen["names"].string, Contains("v(a)") && Contains("i(D2)") && Contains("250 ms") && Contains("1.75 s"));
  CHECK(seen["signature"].truth);
  CHECK(seen["png"][std::size_t{0}].number > 1000.0);
  CHECK(seen["png"][std::size_t{1}].number > 700.0);  // three plots of 240 pixels
  CHECK(seen["bytes"].number > 10'000.0);
}

TEST_CASE("texts have contrast, controls have names and labels of axes are whole, in light and dark, wide and narrow", "[unit]") {
  for (const Window window : {Window{1200, false}, {1200, true}, {phone, false}, {phone, true}}) {
    INFO(window.width << (window.is_dark ? " dark" : " light"));
    const Json seen = used(
        triangle + ".meas top MAX v(a)\n.four 1 v(a)\n.op\n",
        open_all +
            "seen.dark = matchMedia('(prefers-color-scheme: dark)').matches; seen.paper = luminance(backgroundOf(document.body));"
            "seen.pale = paleTexts().join('; '); seen.unnamed = unnamed().join('; '); seen.clipped = clipped.join('; ');"
            "seen.curves = [...document.querySelectorAll('.u-marker')].map(box => contrast(colourParts(getComputedStyle(box).borderColor), "
            "backgroundOf(box))).reduce((a, b) => Math.min(a, b), 99);",
        "#spectrum=&harmonics=10&xy=v(a);i(R1)&from=0.111111&to=0.111112", window);
    if (seen.object.empty()) return;
    REQUIRE(seen["dark"].truth == window.is_dark);
    CHECK((seen["paper"].number < 0.1) == window.is_dark);
    CHECK(seen["pale"].string.empty());
    CHECK(seen["unnamed"].string.empty());
    CHECK(seen["clipped"].string == "");
    CHECK(seen["curves"].number >= 3.0);  // of graphics: WCAG 1.4.11
  }
}

TEST_CASE("the spectrum has the exact harmonics of a trapezoid, and those of .four", "[unit]") {
  // Period 1 ms, from 0 to 10 V; rise and fall 50 µs each, 350 µs between their middles: 20 V d sinc(k d) sinc(k r) with d = 0.35, r = 0.05.
  const Json seen = used(
      "trapezoid\nV1 a 0 PULSE(0 10 0 50u 50u 300u 1m)\nR1 a b 1k\nC1 b 0 1u ic=0\n.tran 0.1m 10m uic\n.save v(a) v(b)\n.four 1k v(b)\n",
      open_all +
          "const titles = (row, cell) => Number(row.children[cell].title);"
          "const rows = [...byId('spectrum-table').rows].slice(1, -1); seen.hint = byId('spectrum-hint').textContent;"
          "seen.a = rows.map(row => titles(row, 1)); seen.b = rows.map(row => titles(row, 3)); seen.phase = rows.map(row => titles(row, "
          "4));"
          "seen.canvas = byId('spectrum-chart').width;",
      "#spectrum=&harmonics=30&A=9e-3&B=10e-3");
  if (seen.object.empty()) return;
  CHECK_THAT(seen["hint"].string, Contains("1 period of 1 kHz"));
  REQUIRE(seen["a"].array.size() == 31);
  const auto sinc = [](double x) { return x == 0.0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x); };
  CHECK(seen["a"][std::size_t{0}].number == Approx(3.5).epsilon(1e-12));
  for (std::size_t k = 1; k <= 30; ++k) {
    INFO("harmonic " << k);
    const double order = static_cast<double>(k);
    CHECK(seen["a"][k].number == Approx(std::abs(20.0 * 0.35 * sinc(0.35 * order) * sinc(0.05 * order))).margin(1e-11));
  }

  const Scratch scratch;
  scratch.write("d.net",
                "t\nV1 a 0 PULSE(0 10 0 50u 50u 300u 1m)\nR1 a b 1k\nC1 b 0 1u ic=0\n.tran 0.1m 10m uic\n.save v(a) v(b)\n.four 1k v(b)\n");
  REQUIRE(run_in(scratch, {"d.net", "--json"}).status == 0);
  const Json run = read_json(run_in(scratch, {"d.net", "--json"}).out);
  const Json& harmonics = run["fourier"][std::size_t{0}]["harmonics"];
  for (std::size_t k = 1; k < harmonics.array.size(); ++k) {
    CHECK(seen["b"][k].number == Approx(harmonics[k]["magnitude"].number).epsilon(1e-9));
    CHECK(std::remainder(seen["phase"][k].number - harmonics[k]["phase"].number, 360.0) == Approx(0.0).margin(1e-6));
  }
}

TEST_CASE("the period of a spectrum is found from the edges of the sources", "[unit]") {
  const Json seen = used("pulses\nV1 a 0 PULSE(0 1 0 1u 1u 3u 10u)\nR1 a 0 1\n.tran 1u 95u\n.save v(a)\n",
                         open_all + "seen.hint = byId('spectrum-hint').textContent;");
  if (!seen.object.empty()) CHECK_THAT(seen["hint"].string, Contains("9 periods of 100 kHz, 5 µs to 95 µs"));
}

TEST_CASE("an x–y plot draws one signal over another", "[unit]") {
  const Json seen =
      used("circle\nV1 a 0 SIN(0 3 50)\nV2 b 0 SIN(0 2 50 0 0 90)\nR1 a 0 1\nR2 b 0 1\n.tran 1m 20m\n.save v(a) v(b)\n",
           "const {x, y, points} = byId('xy-chart').dataset; Object.assign(seen, {x, y, points});"
           "byId('xy-x').value = 'v(b)'; byId('xy-x').dispatchEvent(new Event('change')); await wait(50); seen.kept = view();",
           "#xy=v(a);v(b)");
  if (seen.object.empty()) return;
  // 6 % of room around ±3 V and ±2 V.
  CHECK(std::stod(seen["x"].string) == Approx(-3.0 - 0.36).epsilon(1e-3));
  CHECK(std::stod(seen["y"].string) == Approx(-2.0 - 0.24).epsilon(1e-3));
  CHECK(std::stod(seen["points"].string) > 50.0);
  CHECK(seen["kept"]["xy"].string == "v(b);v(b)");
}

TEST_CASE("a sweep shows measurements against the parameter, and a list of signals and of runs", "[unit]") {
  const Json seen = used(
      "sweep\nV1 a 0 10\nR1 a b {R}\nR2 b 0 {S}\n.step param R 10 100 10\n.step param S list 10 20\n.tran 1m 10m\n.save v(a) v(b) i(R1)\n"
      ".meas m AVG v(b)\n.meas p AVG i(R1)\n",
      open_all +
          "seen.charts = document.documentElement.dataset.sweepCharts; seen.curves = "
          "byId('sweep-charts').querySelector('canvas').dataset.curves;"
          "seen.captions = [...document.querySelectorAll('figcaption')].map(each => each.textContent).join('; ');"
          "const labels = () => [...document.querySelectorAll('#trace-list label')].map(each => each.textContent.trim());"
          "seen.labels = labels(); const only = text => [...document.querySelectorAll('#trace-list span')].find(each => "
          "each.textContent.trim().startsWith(text)).querySelector('button').click();"
          "only('v(b)'); seen.plots = document.documentElement.dataset.plots; only('R=10, S=20');"
          "seen.rows = [...byId('measurements').rows].map(row => row.cells[0].textContent).slice(1); seen.pale = paleTexts().join('; ');"
          "seen.unnamed = unnamed().join('; ');");
  if (seen.object.empty()) return;
  CHECK(seen["charts"].string == "2");
  CHECK(seen["curves"].string == "2");
  CHECK(seen["captions"].string == "m against R; p against R");
  CHECK(seen["labels"][std::size_t{1}].string == "v(b)");
  CHECK(seen["plots"].string == "1");
  REQUIRE(seen["rows"].array.size() == 1);
  CHECK(seen["rows"][std::size_t{0}].string == "v(b), R=10, S=20");
  CHECK(seen["pale"].string.empty());
  CHECK(seen["unnamed"].string.empty());
}

TEST_CASE("a Monte Carlo sweep shows histograms", "[unit]") {
  const Json seen =
      used("draws\nV1 a 0 10\nR1 a b {mc(10,0.2)}\nR2 b 0 10\n.step param run 1 200 1\n.tran 1m 10m\n.save v(b)\n.meas m AVG v(b)\n",
           "const chart = byId('sweep-charts').querySelector('canvas'); seen.bins = (chart.dataset.bins ?? '').split(' ').map(Number);"
           "seen.hint = byId('sweep-charts').querySelector('.hint').textContent;");
  if (seen.object.empty()) return;
  double sum = 0.0;
  for (const Json& bin : seen["bins"].array) sum += bin.number;
  CHECK(sum == 200.0);
  CHECK_THAT(seen["hint"].string, Contains("mean") && Contains("standard deviation"));
}

TEST_CASE("switches within gates show when asked for, and slopes are drawn as slopes", "[unit]") {
  const Json seen = used(
      "gates\nV1 a 0 PULSE(0 1 0 1u 1u 3u 10u)\nV2 b 0 PULSE(0 1 5u 1u 1u 3u 20u)\nA1 a b 0 0 0 0 q 0 SRFLOP\nR1 q 0 1k\nS1 q c a 0 SX\nR2 "
      "c 0 1\n"
      ".model SX SW(Vt=0.5)\n.tran 1u 100u\n",
      "const root = document.documentElement.dataset; seen.folded = root.lanes; seen.offered = !byId('internals-line').hidden;"
      "byId('internals').click(); await wait(50); seen.open = root.lanes;"
      "seen.spare = plotArea(0).clientWidth - Number(root.columns);");
  if (seen.object.empty()) return;
  CHECK(seen["folded"].string == "1");
  CHECK(seen["offered"].truth);
  CHECK(std::stod(seen["open"].string) > 1.0);
  CHECK(seen["spare"].number > 0.0);
}

TEST_CASE("where a long run has only bins an expression lies between its bounds, and its statistics are of what is exact", "[unit]") {
  // v(a) between 2 and 4 V over 1 kΩ: the power between 4 and 16 mW, in every bin of several periods.
  const Json seen =
      used("long\nV1 a 0 SIN(3 1 1k)\nR1 a 0 1k\nV2 b 0 PULSE(0 1 0 1n 1n 50u 100u)\nR2 b 0 1\n.tran 1m 4\n.save v(a) i(R1) v(b)\n",
           "const file = new DOMParser().parseFromString(saved('svg')[1], 'image/svg+xml');"
           "const points = file.querySelector('polyline').getAttribute('points').split(' ').map(point => point.split(',').map(Number));"
           "const early = points.filter(([x]) => x < 300).map(([, y]) => y);"
           "seen.points = early.length; seen.top = Math.min(...early); seen.bottom = Math.max(...early);"
           "seen.rows = byId('measurements').textContent; seen.hint = byId('measurement-hint').textContent;",
           "#expression=v(a)*i(R1)&traces=v(a)*i(R1)&y=0:0:0.02");
  if (seen.object.empty()) return;
  CHECK_THAT(seen["hint"].string, Contains("more events than this page keeps"));
  CHECK(seen["points"].number > 100.0);
  // The plot is 200 high from y = 20 on, for 20 mW to 0.
  CHECK(seen["top"].number == Approx(20.0 + 200.0 * 0.2).margin(0.1));
  CHECK(seen["bottom"].number == Approx(20.0 + 200.0 * 0.8).margin(0.1));
  CHECK_THAT(seen["rows"].string, Contains("16 mW"));
}
