/// The worked examples of docs/concepts: each number against a formula, and the page against the number.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "analysis/inspection.hpp"
#include "engine/exact/exact.hpp"
#include "netlist/load.hpp"
#include "regression/comparison.hpp"
#include "regression/deck_run.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

constexpr double example_bound = 1e-12;  ///< of values of order one
using std::numbers::phi;
using std::numbers::pi;

const std::filesystem::path source_folder = PWLSIM_SOURCE_DIR;

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(source_folder / path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// A page that shows numbers in the form given here.
class Page {
 public:
  explicit Page(const std::string& name) : text_(in_one_line(text_of("docs/concepts/" + name + ".md"))) {}

  /// `value` agrees with `formula`, and the page has its size with as many digits as `format` says.
  void states(double value, double formula, std::string_view format, double tolerance = example_bound) const {
    CHECK(std::abs(value - formula) <= tolerance * std::max(1.0, std::abs(formula)));
    shows(fmt::format(fmt::runtime(format), std::abs(formula)));
  }
  void shows(const std::string& words) const {
    INFO(words);
    CHECK(text_.find(in_one_line(words)) != std::string::npos);
  }

 private:
  /// Where lines end is no matter.
  static std::string in_one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
  }

  std::string text_;
};

DeckRun run_of(const std::string& path, bool events = false) {
  DeckRun run = run_deck(source_folder / path, events);
  INFO(path << ": " << run.messages << run.answer.message);
  REQUIRE(run.messages.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  return run;
}

double at(const DeckRun& run, double time, std::size_t signal) {
  const auto* row = run.row_at(time);
  REQUIRE(row != nullptr);
  return row->at(signal + 1);
}

/// Times of pairs of rows.
std::vector<double> event_times_of(const DeckRun& run) {
  std::vector<double> times;
  for (std::size_t i = 1; i < run.rows.size(); ++i)
    if (run.rows[i][0] == run.rows[i - 1][0]) times.push_back(run.rows[i][0]);
  return times;
}

/// The island with the most states.
analysis::IslandView inspected(const std::string& path, const std::optional<analysis::ModeRequest>& mode = {}) {
  SourceStore sources;
  Diagnostics diagnostics;
  const netlist::Loaded loaded = netlist::load((source_folder / path).string(), sources, diagnostics);
  const auto compiled = circuit::compile(loaded.deck, sources, diagnostics);
  REQUIRE(compiled);
  const auto model = engine::prepare(compiled->network, diagnostics);
  REQUIRE(model);
  const auto inspection = analysis::inspect(*compiled, *model, mode, diagnostics);
  REQUIRE(inspection);
  return *std::max_element(inspection->islands.begin(), inspection->islands.end(),
                           [](const auto& a, const auto& b) { return a.states < b.states; });
}

double distance(const model::Matrix& m, std::initializer_list<double> rows) {
  double worst = rows.size() == static_cast<std::size_t>(m.size()) ? 0.0 : INFINITY;
  auto entry = rows.begin();
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    for (Eigen::Index j = 0; j < m.cols() && std::isfinite(worst); ++j) worst = std::max(worst, std::abs(m(i, j) - *entry++));
  return worst;
}

}  // namespace

TEST_CASE("concepts, ports: each port finds its side", "[regression]") {
  const auto position = inspected("docs/concepts/clamp_and_tank.net").positions.at(0);
  CHECK(position.ports[0].input_is_current);
  CHECK_FALSE(position.ports[1].input_is_current);
  CHECK(distance(position.space.a, {0.0, -0.25, 0.25, 0.0}) <= example_bound);
  CHECK(distance(position.space.b, {std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.125)}) <= example_bound);
  CHECK((position.space.c - position.space.b.transpose()).norm() <= example_bound);
  CHECK(position.space.d.norm() == 0.0);
  CHECK(distance(position.markov.parameters.at(1), {0.5, 0.0, 0.0, 0.125}) <= example_bound);
  const Page page("ports");
  page.shows("diag(0.5, 0.125)");
  const DeckRun run = run_of("docs/concepts/clamp_and_tank.net", true);
  const auto events = event_times_of(run);
  REQUIRE(events.size() == 1);
  page.states(events[0], 2.0 * pi, "t = 2π = {:.6f}");
  for (const auto& row : run.rows) CHECK(std::abs(row[1] - (row[0] < 2.0 * pi ? std::cos(row[0] / 4.0) : 0.0)) <= example_bound);
  page.states(at(run, 20.0, 1), std::sqrt(2.0 / 8.0), "√(C1/L1) = {:.1f} A");
}

TEST_CASE("concepts, ports: one state for two capacitors", "[regression]") {
  const double c1 = 1e-12, c2 = 3e-12, r = 1e6;
  const Page page("ports");
  const auto space = inspected("docs/concepts/divider.net").positions.at(0).space;
  REQUIRE(space.states.at(0).terms.size() == 2);
  page.states(space.states[0].terms[0].coefficient * 1e7, -c1 / std::sqrt(c1 + c2) * 1e7, "= −{:.0f}e-07 v(C1)");
  page.states(space.states[0].terms[1].coefficient * 1e6, c2 / std::sqrt(c1 + c2) * 1e6, "+ {:.1f}e-06 v(C2)");
  page.states(space.a(0, 0), -1.0 / (r * (c1 + c2)), "= −{:.0f} /s");
  const DeckRun run = run_of("docs/concepts/divider.net");
  page.states(at(run, 1e-6, 0), c1 / (c1 + c2), "C1/(C1 + C2) = {:.2f} V");
  page.states(at(run, 5e-6, 0), 0.25 / std::numbers::e, "{:.13f} V after one time constant");
}

// ½·C1·(10 − v)² + ½·C2·v² has its minimum at 10·C1/(C1 + C2), and grows from there to either side: over v ≤ 2 it is least at 2.
TEST_CASE("concepts, operating point: a clamped divider", "[regression]") {
  const Page page("operating-point");
  const DeckRun run = run_of("docs/concepts/clamped_divider.net");
  page.states(at(run, 0.0, 0), std::min(2.0, 10.0 * 1e-6 / (1e-6 + 3e-6)), "{:.2f} V stores the least");
  page.states(10.0 * 1e-6 / (1e-6 + 3e-6), 2.5, "of the source, {:.2f} V");
  CHECK(
      std::any_of(run.answer.remarks.begin(), run.answer.remarks.end(), [](const auto& remark) { return remark.id == "W-op-not-unique"; }));
}

// V and T from the equations of the paper's first page.
TEST_CASE("concepts, modes: two carts", "[regression]") {
  const auto stopped = inspected("netlists/carts.net", analysis::ModeRequest{{"D1", true}});
  CHECK(stopped.mode->consistent == 2);
  CHECK(stopped.mode->jump == 2);
  CHECK(stopped.mode->well_posed);
  CHECK(stopped.positions[0].markov.uniform_degree == 2);
  const auto free = inspected("netlists/carts.net", analysis::ModeRequest{});
  CHECK(free.mode->consistent == 4);
  CHECK(free.mode->jump == 0);
  Page("modes").shows("of dimension 2 of 4");
}

TEST_CASE("concepts, modes: parallel diodes share", "[regression]") {
  const auto island = inspected("docs/concepts/parallel_diodes.net", analysis::ModeRequest{{"D1", true}, {"D2", true}});
  CHECK(island.mode->consistent == 0);
  CHECK(island.mode->indeterminate == std::vector<std::string>{"D1", "D2"});
  const Page page("modes");
  const DeckRun run = run_of("docs/concepts/parallel_diodes.net");
  page.states(at(run, 0.0, 1), 0.5, "{:.1f} A at the start");
  page.states(at(run, 0.25, 2), 0.25, "{:.2f} A\nat t = 0.25");
  page.states(at(run, 1.0, 0), -0.25, "−{:.2f} V at t = 1");
}

// Free motion from (0, p, 0, q) in normal coordinates: frequencies 1/φ (x2 = φ x1) and φ (x2 = −x1/φ).
TEST_CASE("concepts, selection: a short flight", "[regression]") {
  const auto x1 = [](double t) {
    return (1e-4 * (std::cos(t / phi) - std::cos(phi * t)) - (phi * std::sin(t / phi) - std::sin(phi * t) / phi)) / std::sqrt(5.0);
  };
  // Its Taylor series, which does not cancel: x1'' = x2 − 2x1, x2'' = x1 − x2, from x2 = 1e-4, x2' = −1.
  const auto x1_series = [](double t) {
    return 1e-4 * t * t / 2.0 - t * t * t / 6.0 - 3.0 * (1e-4 * t * t * t * t / 24.0 - std::pow(t, 5) / 120.0);
  };
  CHECK(std::abs(x1(0.01) - x1_series(0.01)) <= example_bound);
  double low = 2e-4, high = 4e-4;
  for (int i = 0; i < 60; ++i) (x1_series(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
  const DeckRun run = run_of("docs/concepts/short_flight.net", true);
  const auto events = event_times_of(run);
  REQUIRE(events.size() == 1);
  const Page page("selection");
  CHECK(events[0] == Approx(low).epsilon(1e-10));
  page.shows(fmt::format("hits at {:.13f} s", low));
  // x2 = 1e-4 − t − 1e-4 t²/2 + t³/6 to the fourth order
  const double x2 = 1e-4 - low - 1e-4 * low * low / 2.0 + low * low * low / 6.0;
  CHECK(at(run, 0.0, 4) == 0.0);
  double after = 0.0;
  for (const auto& row : run.rows)
    if (row[0] == events[0]) after = row[5];
  CHECK(after == Approx(-x2).epsilon(1e-10));
  page.shows(fmt::format("−x2 = {:.13f}", -x2));
}

TEST_CASE("concepts, selection: an input that takes the cart away at once", "[regression]") {
  // The free motion under v = t of netlists/paper: x1 = t + a sin(t/φ) + b sin(φt); near 0 it is t⁵/120 − 3t⁷/5040.
  const double t = 0.1;
  const double series = std::pow(t, 5) / 120.0 - 3.0 * std::pow(t, 7) / 5040.0 + 8.0 * std::pow(t, 9) / 362880.0;
  const double value = at(run_of("netlists/paper/carts_input.net"), t, 0);
  CHECK(std::abs(value - series) <= 1e-14);
  Page("selection").shows(fmt::format("{:.6e} at t = 0.1", series));
}

TEST_CASE("concepts, jumps: two capacitors and a corner", "[regression]") {
  const DeckRun shared = run_of("netlists/two_capacitors.net");
  const Page page("jumps");
  page.states(at(shared, 0.0, 0), 1.0, "{:.0f} V on both");
  page.states(at(shared, 0.0, 1), 1.0, "{:.0f} V on both");
  const double energy = 0.5 * (1.0 * at(shared, 0.0, 0) * at(shared, 0.0, 0) + 2.0 * at(shared, 0.0, 1) * at(shared, 0.0, 1));
  page.states(energy, 0.5 * 3.0, "4.5 J to {:.1f} J");
  const DeckRun leave = run_of("netlists/paper/carts_leave.net");
  page.states(at(leave, 0.1, 0), (std::cos(0.1 / phi) - std::cos(0.1 * phi)) / std::sqrt(5.0), "{:.12f} at t = 0.1");
  // Plastic impact: the wall that is hit at right angles takes vx, the other is left with n2·v = 0.2 √3/2. All walls at once: −G⁻¹ N v, G = [1 ½; ½ 1].
  const DeckRun corner = run_of("docs/concepts/corner.net");
  CHECK(std::abs(at(corner, 0.0, 2)) <= example_bound);
  CHECK(std::abs(at(corner, 0.0, 3) - 0.2) <= example_bound);
  CHECK(std::abs(at(corner, 1.0, 1) - 0.2) <= example_bound);
  const double v1 = -1.0, v2 = -0.5 + 0.1 * std::sqrt(3.0);
  page.shows(fmt::format("n2·v = −{:.4f}", -v2));
  page.shows(fmt::format("{:.3f} and **−{:.3f}**", -(v1 - 0.5 * v2) / 0.75, (v2 - 0.5 * v1) / 0.75));
  page.states(at(corner, 0.0, 2) * 0.5 + at(corner, 0.0, 3) * std::sqrt(0.75), 0.1 * std::sqrt(3.0), "n2·v⁺ = {:.6f}");
}

TEST_CASE("concepts, events: infinitely many", "[regression]") {
  const DeckRun run = run_of("docs/concepts/twisting.net", true);
  const Page page("events");
  page.states(event_times_of(run).back(), 1.0 + 2.0 / std::sqrt(3.0), "{:.16f}");
  CHECK(std::abs(at(run, 2.25, 0)) <= example_bound);
  CHECK(std::abs(at(run, 3.0, 1)) <= example_bound);
  CHECK(run.answer.statistics.accumulations == 1);
}

TEST_CASE("concepts, events: the extinction angle and a near touch", "[regression]") {
  double low = pi, high = 5.0;
  const auto current = [](double t) { return std::sin(t - pi / 4.0) + std::sin(pi / 4.0) * std::exp(-t); };
  for (int i = 0; i < 100; ++i) (current(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
  const Page page("events");
  const auto extinction = event_times_of(run_of("docs/concepts/rl_rectifier.net", true));
  REQUIRE(extinction.size() == 1);
  page.states(extinction[0], low, "β = {:.15f}", 1e-14);

  const double eps = 1e-8, speed = std::sqrt(2.0 * eps + eps * eps);
  const DeckRun run = run_of("docs/concepts/near_touch.net", true);
  const auto events = event_times_of(run);
  REQUIRE(events.size() == 1);
  page.states(events[0], std::atan2(1.0, speed), "= {:.9f}");
  const auto before = std::find_if(run.rows.begin(), run.rows.end(), [&](const auto& row) { return row[0] == events[0]; });
  page.states((*before)[2], speed, "speed {:.3e}", 1e-10);
  CHECK(std::abs((*std::next(before))[2]) <= example_bound);
  for (const auto& row : run.rows) CHECK(std::abs(row[3] - (1.0 - eps) * std::sin(row[0])) <= example_bound);
}

TEST_CASE("concepts, certificates: what is certified, and two starts that approach", "[regression]") {
  using analysis::CertificateKind;
  const Page page("certificates");
  const auto capacitors = inspected("netlists/two_capacitors.net").positions.at(0);
  CHECK(capacitors.certificate.kind == CertificateKind::passive);
  page.states(capacitors.markov.parameters.at(1)(0, 0), 1.0 + 0.5, "1/C1 + 1/C2 = {:.1f}");
  const auto carts = inspected("netlists/carts.net").positions.at(0);
  CHECK(carts.certificate.kind == CertificateKind::principal_minors);
  page.states(carts.markov.parameters.at(2)(0, 0), 1.0, "CAB = {:.0f}");
  CHECK(inspected("netlists/paper/relay_right.net").positions.at(0).certificate.kind == CertificateKind::none);
  const auto saturation = inspected("netlists/paper/saturation.net").positions.at(0);
  CHECK(distance(saturation.space.d, {1.0, 0.0, 0.0, 1.0}) <= example_bound);
  CHECK(saturation.certificate.kind == CertificateKind::principal_minors);

  const DeckRun run = run_of("docs/concepts/two_starts.net");
  const auto apart = [](const std::vector<double>& row) {
    return 0.5 * 100e-6 * (row[1] - row[3]) * (row[1] - row[3]) + 0.5 * 1e-3 * (row[2] - row[4]) * (row[2] - row[4]);
  };
  page.states(apart(run.rows[0]), 0.5 * 100e-6 * 400.0, "is {:.2f} J");
  for (std::size_t k = 1; k < run.rows.size(); ++k) CHECK(apart(run.rows[k]) <= apart(run.rows[k - 1]));
  page.shows(fmt::format("{:.4e} J after 10 ms", apart(*run.row_at(0.01))));
  page.shows(fmt::format("through {} events", run.answer.statistics.events));
}

// u(s) = 1 + s/(s² + 1) from (0, −1, −1, 0): an impulse, then cos t.
TEST_CASE("concepts, paper: the force of the stop", "[regression]") {
  const DeckRun run = run_of("netlists/paper/carts_hit.net");
  Page("paper").states(at(run, 0.1, 4), std::cos(0.1), "cos t, {:.12f} at t = 0.1");
}

TEST_CASE("concepts: every deck of the pages stands in one of them", "[regression]") {
  std::string pages;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder / "docs/concepts"))
    if (entry.path().extension() == ".md") pages += text_of("docs/concepts/" + entry.path().filename().string());
  for (const auto& deck : decks_in("docs/concepts")) {
    INFO(deck.string());
    CHECK(pages.find("(" + deck.filename().string() + ")") != std::string::npos);
  }
}
