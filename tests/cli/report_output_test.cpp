// --report: a run as one web page, looked at in headless Chromium where that is installed.

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <csignal>

#include "cli/many_rows.hpp"
#include "cli/page.hpp"
#include "cli/run_in.hpp"
#include "waveform/svg_plot.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;
using Names = std::vector<std::string>;

namespace {

/// v(a) is a triangle from 0 to 2 V and back within 2 s; i(R1) a thousandth of it; D2 conducts while v(a) is above 1 V.
const std::string marked_up_triangle =
    "triangle </script><b>\n"
    "V1 a 0 PWL(0 0 1 2 2 0)\n"
    "R1 a 0 1k\n"
    "R2 a b 1\n"
    ".model DI D\n"
    ".tran 0.01 2\n"
    ".save v(a) i(R1) i(D2)\n"
    "D2 b d DI\n"
    "V3 d 0 1\n";

}  // namespace

// A conductance of −1 S across 1 µF: v(a) grows by e each microsecond, beyond 10³⁰⁸ after 0.7 ms.
TEST_CASE("a run that leaves the range of numbers has a page", "[unit]") {
  const Scratch scratch;
  scratch.write("g.net", "t\nC1 a 0 1u ic=1\nG1 0 a a 0 1\nL1 a b 1m\nR1 b 0 1\nD1 b 0 DI\n.model DI D\n.tran 1u 2m uic\n.end\n");
  const Finished finished = run_in(scratch, {"g.net", "--report", "g.html"});
  CHECK(finished.status == 1);
  CHECK_THAT(finished.err, Contains("error[E-overflow]"));
  CHECK_THAT(finished.err, !Contains("E-internal"));
  CHECK(scratch.holds("g.html"));
}

TEST_CASE("a report is one page that asks nothing of any network", "[unit]") {
  const Scratch scratch;
  scratch.write("t.net", marked_up_triangle);
  REQUIRE(run_in(scratch, {"t.net", "--report", "r.html"}).status == 0);
  CHECK(scratch.names() == Names{"r.html", "t.csv", "t.net"});
  const std::string page = read_file(scratch / "r.html");
  CHECK_THAT(page, Catch::Matchers::StartsWith("<!DOCTYPE html>") && Catch::Matchers::EndsWith("</html>\n"));
  CHECK_THAT(page, Contains("default-src 'none'"));
  for (const char* fetching : {"src=", "href=", "url(", "@import", "fetch(", "XMLHttpRequest", "WebSocket", "sendBeacon", "import("})
    CHECK_THAT(page, !Contains(fetching));
  CHECK_THAT(page, !Contains("@data@") && !Contains("@script@") && !Contains("@style@"));
}

TEST_CASE("a report holds the solution, the events, the modes and the run itself", "[unit]") {
  const Scratch scratch;
  scratch.write("t.net", marked_up_triangle);
  REQUIRE(run_in(scratch, {"t.net", "--report", "r.html"}).status == 0);
  const Json data = data_of(read_file(scratch / "r.html"));
  REQUIRE(data["signals"].array.size() == 3);
  for (const double time : {0.0, 0.123456789, 0.5, 1.0, 1.7, 2.0}) {
    const double triangle_value = 2.0 - 2.0 * std::abs(1.0 - time);
    CHECK(value_of(data, 0, time) == Approx(triangle_value).margin(1e-12));
    CHECK(value_of(data, 1, time) == Approx(1e-3 * triangle_value).margin(1e-15));
  }
  CHECK(data["panels"].array.size() == 2);
  // D2 conducts from 0.5 s to 1.5 s.
  CHECK(data["eventCount"].number == 2.0);
  CHECK(data["events"][0]["time"].number == Approx(0.5));
  CHECK(data["events"][0]["changes"].string == "D2 on");
  CHECK(data["run"]["output"]["file"].string == "t.csv");
  CHECK(data["run"]["stats"]["certificate"]["passive"].truth);
  CHECK(data["run"]["title"].string == "triangle ?/script>?b>");  // our reader shows every \\u as a question mark
}

TEST_CASE("Chromium draws the waveforms and measures between the cursors", "[unit]") {
  const Scratch scratch;
  scratch.write("t.net", marked_up_triangle);
  REQUIRE(run_in(scratch, {"t.net", "--report", "r.html"}).status == 0);
  const std::string page = without_titles(shown(scratch, "r.html", "#A=0.5&B=1"));
  if (page.empty()) return;
  CHECK_THAT(page, Contains("data-plots=\"3\"") && Contains("data-drawn=\"3\"") && Contains("data-ready=\"true\""));
  CHECK_THAT(page, Contains("data-lanes=\"1\""));
  CHECK_THAT(page, Contains("triangle &lt;/script&gt;&lt;b&gt;"));
  CHECK_THAT(page, Contains("B − A = 500 ms") && Contains("1/|B − A| = 2 Hz"));
  // From 1 V to 2 V along a straight line: mean 1.5 V, RMS sqrt(7/3) V.
  CHECK_THAT(page, Contains("<tr><td>v(a)</td><td>1 V</td><td>2 V</td><td>1 V</td><td>1 V</td><td>2 V</td><td>1 V</td><td>1.5 "
                            "V</td><td>1.52753 V</td></tr>"));
  CHECK_THAT(page, Contains("<td>500 ms</td><td>mode change</td><td>D2 on</td>"));
}

namespace {

/// A buck converter in discontinuous conduction and a ripple that rows 37 µs apart know nothing of; measured over all and between 300 µs and 1.2345 ms.
const std::string coarse_rows =
    "buck\nV1 in 0 24\nVg g 0 PULSE(0 1 0 0 0 3u 10u)\nS1 in sw g 0 SX\nD1 0 sw DX\nL1 sw out 10u ic=0\nC1 out 0 22u ic=0\nR1 out 0 8\n"
    ".model SX SW(Ron=20m Vt=0.5)\n.model DX D(Ron=10m Vfwd=0.4)\n.tran 37u 2m uic\n.save v(out) i(L1)\n"
    ".meas vmean AVG v(out)\n.meas vrms RMS v(out)\n.meas vmin MIN v(out)\n.meas vmax MAX v(out)\n"
    ".meas imean AVG i(L1)\n.meas irms RMS i(L1)\n.meas imax MAX i(L1)\n"
    ".meas wmean AVG i(L1) FROM=300u TO=1.2345m\n.meas wrms RMS i(L1) FROM=300u TO=1.2345m\n.meas wmin MIN v(out) FROM=300u TO=1.2345m\n"
    ".meas wmax MAX v(out) FROM=300u TO=1.2345m\n";

double measurement(const Json& data, const std::string& name) {
  for (const Json& each : data["run"]["measurements"].array)
    if (each["name"].string == name) return each["value"].number;
  FAIL("no measurement " << name);
  return 0.0;
}

/// Rows of the page's table (minimum, maximum, peak to peak, mean, RMS) beside the measurements of `coarse_rows` over all.
template <class Same>
void check_whole_run(const std::vector<double>& v, const std::vector<double>& i, const Same& same) {
  REQUIRE(v.size() == 5);
  REQUIRE(i.size() == 5);
  same(v[1], "vmax");
  same(v[3], "vmean");
  same(v[4], "vrms");
  same(i[1], "imax");
  same(i[3], "imean");
  same(i[4], "irms");
}

}  // namespace

TEST_CASE("statistics of the page are those of .meas, whatever the rows are, between the cursors too", "[unit]") {
  const Scratch scratch;
  scratch.write("b.net", coarse_rows);
  REQUIRE(run_in(scratch, {"b.net", "--report", "r.html"}).status == 0);
  const Json data = data_of(read_file(scratch / "r.html"));
  CHECK(data["thinned"].truth == false);
  const auto same = [&](double value, const std::string& name) {
    CHECK(value == Approx(measurement(data, name)).epsilon(1e-9).margin(1e-9));
  };
  const std::string whole = shown(scratch, "r.html");
  if (whole.empty()) return;
  const auto v = figures_of(whole, "v(out)"), i = figures_of(whole, "i(L1)");
  check_whole_run(v, i, same);
  same(v[0], "vmin");
  const std::string window = shown(scratch, "r.html", "#A=300e-6&B=1.2345e-3");
  const auto vw = figures_of(window, "v(out)"), iw = figures_of(window, "i(L1)");
  REQUIRE(vw.size() == 8);
  same(vw[3], "wmin");
  same(vw[4], "wmax");
  same(iw[6], "wmean");
  same(iw[7], "wrms");
}

TEST_CASE("a run of a hundred thousand events is a page of less than 5 MB, with exact statistics", "[unit]") {
  const Scratch scratch;
  std::string deck = coarse_rows;
  deck.replace(deck.find(".tran 37u 2m"), 12, ".tran 1m 400m");
  scratch.write("b.net", deck);
  REQUIRE(run_in(scratch, {"b.net", "--report", "r.html"}).status == 0);
  const std::string file = read_file(scratch / "r.html");
  constexpr std::size_t most_bytes = 5'000'000;
  CHECK(file.size() < most_bytes);
  const Json data = data_of(file);
  CHECK(data["eventCount"].number > 1e5);
  CHECK(data["thinned"].truth);
  const std::string page = shown(scratch, "r.html");
  if (page.empty()) return;
  CHECK_THAT(page, Contains("data-drawn=\"2\""));
  const auto v = figures_of(page, "v(out)"), i = figures_of(page, "i(L1)");
  check_whole_run(v, i, [&](double value, const std::string& name) { CHECK(value == Approx(measurement(data, name)).epsilon(1e-9)); });
}

TEST_CASE("an address may ask for expressions of traces, and for some of the traces", "[unit]") {
  const Scratch scratch;
  scratch.write("t.net", marked_up_triangle);
  REQUIRE(run_in(scratch, {"t.net", "--report", "r.html"}).status == 0);
  const std::string page = shown(
      scratch, "r.html", "#from=0&to=1&expression=v(a)*i(R1)%2B2*v(a)*i(D2)&expression=v(a)+*&traces=v(a)*i(R1)%2B2*v(a)*i(D2);i(D2)");
  if (page.empty()) return;
  CHECK_THAT(page, Contains("cannot read") || Contains("no signal or number"));
  CHECK_THAT(page, Contains("data-plots=\"2\"") && Contains("2 of 4"));
  CHECK_THAT(page, !Contains("<tr><td>v(a)</td>"));
  // 0 to 1 s: v = 2t, i(R1) = 2t/1000, i(D2) = 2t - 1 from 0.5 s on: ∫ 4t²/1000 dt + ∫ 4t(2t - 1) dt = 4/3000 + 8/3·7/8 - 2·3/4.
  const auto power = figures_of(page, "v(a)*i(R1)+2*v(a)*i(D2)");
  REQUIRE(power.size() == 5);
  CHECK(power[3] == Approx(4.0 / 3000.0 + 7.0 / 3.0 - 1.5).epsilon(1e-9));
  CHECK(power[1] == Approx(4.0 / 1000.0 + 4.0).epsilon(1e-9));
}

TEST_CASE("a report shows the measurements of the deck", "[unit]") {
  const Scratch scratch;
  // 1 V + 2 V sin: the mean is 1 V, the least value at three quarters of the period, the fundamental 2 V; a tenth of 3 V is 0.3 V.
  scratch.write("m.net",
                "m\nV1 a 0 SIN(1 2 50)\nR1 a b 9k\nR2 b 0 1k\n.tran 0.1m 40m\n.save v(a) v(b)\n.meas tran mean AVG v(a)\n.meas tran top "
                "MAX v(b)\n.meas low min_at v(a) from=0 to=20m\n"
                ".four 50 v(a)\n");
  REQUIRE(run_in(scratch, {"m.net", "--report", "r.html"}).status == 0);
  const std::string page = shown(scratch, "r.html");
  if (page.empty()) return;
  CHECK_THAT(page, Contains("<tr><td>mean</td><td>1 V</td></tr>") && Contains("<tr><td>top</td><td>300 mV</td></tr>") &&
                       Contains("<tr><td>low</td><td>15 ms</td></tr>"));
  CHECK_THAT(page, Contains("Fourier analysis of v(a)") && Contains("<tr><td>50 Hz</td><td>2</td>"));
}

TEST_CASE("a report lists what does not run as written", "[unit]") {
  const Scratch scratch;
  scratch.write("d.net", "d\nV1 a 0 SIN(0 1 50)\nD1 a b DX\nR1 b 0 1k\n.model DX D(IS=1n N=1 CJO=1p)\n.tran 1m 20m\n");
  REQUIRE(run_in(scratch, {"d.net", "--report", "r.html"}).status == 0);
  const Json data = data_of(read_file(scratch / "r.html"));
  REQUIRE(data["run"]["idealisation"].array.size() == 2);
  const std::string page = shown(scratch, "r.html");
  if (!page.empty()) CHECK_THAT(page, Contains("<td>replaced</td><td>d.net:") && Contains("<td>ignored</td><td>d.net:"));
}

TEST_CASE("--report of a sweep: curves of the runs on one axis of times, and a table of the runs", "[unit]") {
  const Scratch scratch;
  // The second run ends earlier and has rows of its own.
  scratch.write("d.net", "report\nV1 a 0 PWL(0 0 8 8)\nR1 a 0 1\n.step param T list 8 6\n.tran 4 {T}\n.save v(a)\n.meas m MAX v(a)\n");
  REQUIRE(run_in(scratch, {"d.net", "--report", "r.html"}).status == 0);
  const Json data = data_of(read_file(scratch / "r.html"));
  const auto numbers = [](const Json& list) {
    std::vector<double> values;
    for (const Json& value : list.array) values.push_back(value.number);
    return values;
  };
  REQUIRE(data["signals"].array.size() == 2);
  CHECK(data["signals"][0]["name"].string == "v(a), T=8");
  CHECK(end_of(data, 0) == 8.0);
  CHECK(end_of(data, 1) == 6.0);
  for (const std::size_t run : {0, 1})
    for (const double time : {0.0, 1.1, 6.0}) CHECK(value_of(data, run, time) == Approx(time).margin(1e-12));
  CHECK(data["signals"][1]["colour"].string == pwlsim::waveform::ramp_colour(1.0));
  CHECK(numbers(data["panels"][0]) == std::vector<double>{0, 1});
  CHECK(data["run"]["runs"].array.size() == 2);
  CHECK(data["drawnRuns"].number == 2.0);

  const std::string page = without_titles(shown(scratch, "r.html", "#A=7"));
  if (page.empty()) return;
  CHECK_THAT(page, Contains("data-plots=\"1\"") && Contains("data-drawn=\"1\"") && Contains("data-runs=\"2\""));
  // Means of a triangle: half of its end; the second run has no value at 7 s.
  CHECK_THAT(page, Contains("<tr><td>v(a), T=8</td><td>7 V</td><td>–</td><td>–</td><td>0 V</td><td>8 V</td><td>8 V</td><td>4 V</td>") &&
                       Contains("<tr><td>v(a), T=6</td><td>–</td><td>–</td><td>–</td><td>0 V</td><td>6 V</td><td>6 V</td><td>3 V</td>"));
  CHECK_THAT(page, Contains("<tr><td>8</td><td>8 V</td><td>3</td>") && Contains("<tr><td>6</td><td>6 V</td><td>3</td>"));
}

TEST_CASE("pictures and reports of a sweep show when diodes and switches of each run change", "[unit]") {
  const Scratch scratch;
  // From 0 to 2 V and back in 2 s: above E from E/2 to 2 - E/2. At 4 V the diode never conducts.
  scratch.write("d.net",
                "ticks\nV1 a 0 PWL(0 0 1 2 2 0)\nR1 a b 1\nD1 b d DI\nV2 d 0 {E}\n.model DI D\n.step param E list 1 0.5 4\n.tran 0.1 "
                "2\n.save v(b)\n");
  REQUIRE(run_in(scratch, {"d.net", "--report", "r.html", "--plot", "p.svg"}).status == 0);
  const Json data = data_of(read_file(scratch / "r.html"));
  REQUIRE(data["marks"].array.size() == 3);
  const std::string picture = read_file(scratch / "p.svg");
  CHECK_THAT(picture, Contains(">tick: a diode or switch changes, or a state jumps<"));
  const auto check_run = [&](std::size_t run, const std::string& name, const std::vector<double>& times) {
    const Json& marks = data["marks"][run];
    const std::string colour = pwlsim::waveform::ramp_colour(0.5 * static_cast<double>(run));
    CHECK(marks["name"].string == name);
    CHECK(marks["colour"].string == colour);
    REQUIRE(marks["x"].array.size() == times.size());
    for (std::size_t k = 0; k < times.size(); ++k) {
      CHECK(marks["x"][k].number == Approx(times[k]));
      // 800 units of width are 2 s; ticks stand at the left of columns half a unit wide.
      const auto place = [&](double x) { return "<line x1=\"" + fmt::format("{:.1f}", x) + "\""; };
      const double x = 110.0 + 400.0 * times[k];
      CHECK_THAT(picture, Contains(place(x)) || Contains(place(x - 0.5)));
    }
    CHECK_THAT(picture, Contains("fill=\"" + colour + "\">" + name + "<"));
  };
  check_run(0, "E=1", {0.5, 1.5});
  check_run(1, "E=0.5", {0.25, 1.75});
  check_run(2, "E=4", {});
  const std::string page = shown(scratch, "r.html");
  if (!page.empty())
    CHECK_THAT(page, Contains("data-marks=\"3\"") && Contains("One line per run, with a tick where a diode or switch changes"));
}

TEST_CASE("a view in the address is what the page shows", "[unit]") {
  const Scratch scratch;
  scratch.write("t.net", marked_up_triangle);
  REQUIRE(run_in(scratch, {"t.net", "--report", "r.html"}).status == 0);
  const std::string page = without_titles(shown(scratch, "r.html", "#from=1.5&to=2"));
  if (page.empty()) return;
  CHECK_THAT(page,
             Contains("visible: 1.5 s to 2 s") && Contains("<tr><td>v(a)</td><td>–</td><td>–</td><td>–</td><td>0 V</td><td>1 V</td>"));
}

TEST_CASE("a report without .tran shows the operating point", "[unit]") {
  const Scratch scratch;
  scratch.write("op.net", "op\nV1 a 0 3\nR1 a 0 1k\n.op\n.save v(a)\n");
  REQUIRE(run_in(scratch, {"op.net", "--report", "r.html"}).status == 0);
  const std::string page = shown(scratch, "r.html");
  if (!page.empty()) CHECK_THAT(page, Contains("<tr><td>v(a)</td><td>3 V</td></tr>"));
}

TEST_CASE("a report of a run that fails or is interrupted holds the rows up to then and says why", "[unit]") {
  const Scratch scratch;
  scratch.write("many.net", many_rectified_rows);
  Spawned program({"many.net", "--report", "r.html", "--plot", "p.svg", "--format", "raw"}, {.folder = scratch.path().string()});
  REQUIRE(wait_until(30, [&] { return scratch.holds("many.raw.partial"); }));
  pause(500);
  program.send(SIGTERM);
  CHECK(program.finish().status == 128 + SIGTERM);
  CHECK(scratch.names() == Names{"many.net", "many.raw", "p.svg", "r.html"});
  const Json data = data_of(read_file(scratch / "r.html"));
  CHECK(data["run"]["status"].number == 128 + SIGTERM);
  CHECK_THAT(data["run"]["notes"].array.back().string, Contains("E-interrupted"));
  CHECK(data["records"][std::size_t{0}]["edges"].array.size() > 1);
}

TEST_CASE("a report that finds no room has status 3, and an older one stays", "[unit]") {
  const Scratch scratch;
  scratch.write("t.net", marked_up_triangle);
  scratch.write("r.html", "old\n");
  const Finished finished = run_in(scratch, {"t.net", "--report", "r.html"}, {.file_size = 50'000});
  CHECK(finished.status == 3);
  CHECK_THAT(finished.err, Contains("error[E-cannot-write]: r.html"));
  CHECK(read_file(scratch / "r.html") == "old\n");
  CHECK(scratch.holds("t.csv"));
}
