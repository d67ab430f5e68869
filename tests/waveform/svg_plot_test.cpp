#include "waveform/svg_plot.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <string>

using namespace pwlsim::waveform;
using Catch::Matchers::Contains;
using Numbers = std::vector<double>;

namespace {

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t number = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++number;
  return number;
}

Figure figure_of(Curve curve) { return {"title", "time", "s", {{"v(a)", {std::move(curve)}}}}; }

}  // namespace

TEST_CASE("ticks are round and lie within the span", "[unit]") {
  CHECK(round_ticks(0.0, 10.0, 5) == Numbers{0.0, 2.0, 4.0, 6.0, 8.0, 10.0});
  CHECK(round_ticks(-1.0, 1.0, 4) == Numbers{-1.0, -0.5, 0.0, 0.5, 1.0});
  const Numbers small = round_ticks(0.0, 5e-3, 5);
  REQUIRE(small.size() == 6);
  CHECK(small[5] == Approx(5e-3).epsilon(1e-14));
}

TEST_CASE("a figure is one self-contained SVG with a panel and its curves", "[unit]") {
  const std::string text =
      svg({"a < b & c", "time", "s", {{"v(a)", {{"one", {0, 1e-3}, {0, 5}, false}, {"two", {0, 1e-3}, {5, 0}, true}}}, {"i", {}}}});
  CHECK(text.find("<svg xmlns=\"http://www.w3.org/2000/svg\"") == 0);
  CHECK_THAT(text, Catch::Matchers::EndsWith("</svg>\n"));
  CHECK_THAT(text, Contains("a &lt; b &amp; c") && Contains("time (ms)") && Contains(">one<") && Contains(">two<"));
  CHECK(count(text, "<polyline") == 2);
  CHECK(count(text, "href") == 0);
}

TEST_CASE("a curve runs from corner to corner of the panel", "[unit]") {
  // 930 wide, margins 110 and 20: from x = 110 to x = 910; the panel is 180 high with 5 % of the span above and below.
  const std::string text = svg(figure_of({"", {0, 1}, {0, 1}, false}));
  CHECK_THAT(text, Contains("points=\"110.00,211.82 910.00,48.18 \""));
}

TEST_CASE("a long curve is drawn by its extremes: a spike of one point stays", "[unit]") {
  Curve curve{"", {}, {}, false};
  for (int k = 0; k <= 100'000; ++k) {
    curve.x.push_back(k);
    curve.y.push_back(k == 54'321 ? 1.0 : 0.0);
  }
  const std::string text = svg(figure_of(std::move(curve)));
  CHECK(text.size() < 100'000);
  CHECK(count(text, ",48.18 ") == 1);
}

TEST_CASE("what is not finite is left out", "[unit]") {
  const std::string text = svg(figure_of({"", {0, 1, 2}, {0, std::numeric_limits<double>::quiet_NaN(), 1}, false}));
  CHECK_THAT(text, Contains("points=\"110.00,211.82 910.00,48.18 \"") && !Contains("nan"));
}

TEST_CASE("a run of one row, and values that differ by rounding, are drawn", "[unit]") {
  // In the middle of the 800 units of width, and of the 180 of height above y = 220.
  CHECK_THAT(svg(figure_of({"", {0}, {1}, false})), Contains("points=\"510.00,130.00 \""));
  CHECK_THAT(svg(figure_of({"", {0, 1}, {5.0, std::nextafter(5.0, 6.0)}, false})), Contains("points=\"110.00,130.00 910.00,130.00 \""));
}

TEST_CASE("a lane is a bar where it is on, shaded where it is on for a share of the time", "[unit]") {
  Figure figure = figure_of({"", {0, 1}, {0, 1}, false});
  figure.lanes = {{"D<1>", {0.0, 0.25, 0.5}, {1.0, 0.0, 0.5}}};
  const std::string text = svg(figure);
  // The panel ends at 220; 16 below it the strip begins. 800 units of width are one second.
  CHECK_THAT(text, Contains("<rect x=\"110\" y=\"238\" width=\"200\" height=\"11\" fill=\"#1f5fbf\" fill-opacity=\"1\"/>"));
  CHECK_THAT(text, Contains("<rect x=\"510\" y=\"238\" width=\"400\" height=\"11\" fill=\"#1f5fbf\" fill-opacity=\"0.5\"/>"));
  CHECK(count(text, "fill-opacity") == 2);
  CHECK_THAT(text, Contains("D&lt;1&gt;"));
}

TEST_CASE("of a long name of a lane the end is shown, in whole letters", "[unit]") {
  Figure figure = figure_of({"", {0, 1}, {0, 1}, false});
  figure.lanes = {{"X1.aµµµµµµµµ", {0.0}, {0.0}}, {"X1.X2.X3.X4.X5.D1", {0.0}, {0.0}}};
  CHECK_THAT(svg(figure), Contains(">…µµµµµµµ<") && Contains(">….X2.X3.X4.X5.D1<"));
}

TEST_CASE("marks are ticks, one for all that fall into one column", "[unit]") {
  Figure figure = figure_of({"", {0, 1}, {0, 1}, false});
  const std::size_t without = count(svg(figure), "#d1480a");
  figure.marks = {{"jumps", {0.5, 0.50001, 0.75, 2.0}}};
  CHECK(count(svg(figure), "#d1480a") == without + 2);
}

TEST_CASE("marks have a colour of their own, and become a pale bar where they cannot be told apart", "[unit]") {
  Figure figure = figure_of({"", {0, 1}, {0, 1}, false});
  std::vector<double> crowd{0.25, 0.5};
  for (int k = 0; k <= 1600; ++k) crowd.push_back(0.75 + 0.125 * k / 1600.0);
  figure.marks = {{"R=1", crowd, "#123456"}, {"R=2", {0.5}, "#654321"}};
  figure.strip_title = "ticks <here>";
  const std::string text = svg(figure);
  // 800 units of width are one second: the crowd reaches from 710 to 810, in columns half a unit wide.
  CHECK_THAT(text, Contains("<rect x=\"710\" y=\"238\" width=\"100.5\" height=\"11\" fill=\"#123456\" fill-opacity=\"0.4\"/>"));
  CHECK(count(text, "stroke=\"#123456\"") == 2);
  CHECK(count(text, "stroke=\"#654321\"") == 1);
  CHECK_THAT(text, Contains("fill=\"#123456\">R=1<") && Contains("fill=\"#654321\">R=2<") && Contains(">ticks &lt;here&gt;<"));
}

TEST_CASE("the values of a panel carry its unit", "[unit]") {
  CHECK_THAT(svg({"", "time", "s", {{"", {{"", {0, 1}, {0, 2e-3}, false}}, "V"}}}), Contains(">1 mV<") && Contains(">0<"));
}
