#include "tables/hard_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "regression/deck_run.hpp"
#include "regression/reference.hpp"
#include "regression/twisting.hpp"
#include "support/scratch.hpp"

namespace pwlsim::test {
namespace {

constexpr double nearest_bound = 1e-5;  ///< of a run's length: events further apart are others
constexpr int touching_case = 31;
constexpr double decided = 1e-9;  ///< beyond this a sign is not rounding

Measured failed(const std::string& problem) {
  Measured result;
  result.problem = problem;
  return result;
}

Measured told(const std::string& outcome) {
  Measured result;
  result.outcome = "reported: " + outcome;
  return result;
}

std::filesystem::path folder(const std::string& name) { return std::filesystem::path(PWLSIM_SOURCE_DIR) / name; }

void raise(std::optional<double>& worst, double error) { worst = std::max(worst.value_or(0.0), error); }

/// Why a run cannot be measured, or nothing.
std::string problem_of(const DeckRun& run) {
  if (!run.messages.empty()) return run.messages;
  return run.answer.outcome == engine::Outcome::completed ? "" : run.answer.message;
}

void measure_rows(const DeckRun& run, const Reference& reference, Measured& result) {
  for (const auto& expected : reference.rows) {
    const auto* row = run.row_at(expected[0]);
    if (row == nullptr) {
      result.problem = fmt::format("no row at {}", expected[0]);
      return;
    }
    for (std::size_t k = 0; k < reference.signals.size(); ++k)
      raise(result.value, std::abs((*row)[k + 1] - expected[k + 1]) / reference.maximum(k));
  }
}

/// The row just after the event nearest to `time`; null where there is none near it.
const std::vector<double>* event_near(const DeckRun& run, double time) {
  const std::vector<double>* best = nullptr;
  for (std::size_t i = 1; i < run.rows.size(); ++i) {
    const auto& row = run.rows[i];
    if (row[0] != run.rows[i - 1][0] || std::abs(row[0] - time) > nearest_bound * run.stop) continue;
    if (best == nullptr || std::abs(row[0] - time) < std::abs((*best)[0] - time)) best = &row;
  }
  return best;
}

void measure_events(const DeckRun& run, const Reference& reference, Measured& result) {
  for (const auto& expected : reference.events) {
    if (!expected.counts()) continue;
    const auto* row = event_near(run, expected.time);
    if (row == nullptr) {
      if (!result.touch) result.problem = fmt::format("no event at {}", expected.time);
      continue;
    }
    raise(result.event_time, std::abs((*row)[0] - expected.time) / run.stop);
    for (std::size_t k = 0; k < reference.signals.size(); ++k)
      raise(result.value, std::abs((*row)[k + 1] - expected.after[k]) / reference.maximum(k));
  }
}

void measure_deck(const std::filesystem::path& deck, Measured& result) {
  const Reference reference = read_reference(deck.stem().string());
  const DeckRun plain = run_deck(deck), with_events = run_deck(deck, true);
  result.problem = problem_of(plain) + problem_of(with_events);
  if (!result.problem.empty()) return;
  measure_rows(plain, reference, result);
  measure_events(with_events, reference, result);
}

Measured measure_decks(int number) {
  Measured result;
  result.touch = number == touching_case;
  const auto stem = fmt::format("case{:02}", number);
  std::vector<std::filesystem::path> decks;
  for (const auto& entry : std::filesystem::directory_iterator(folder("tests/hard")))
    if (entry.path().extension() == ".net" && entry.path().stem().string().rfind(stem, 0) == 0) decks.push_back(entry.path());
  std::sort(decks.begin(), decks.end());
  if (decks.empty()) result.problem = "no deck";
  for (const auto& deck : decks)
    if (result.problem.empty()) measure_deck(deck, result);
  return result;
}

DeckRun run_raw(const std::string& file, const std::string& cards) {
  const Scratch scratch;
  return run_text("raw\n.lcs s \"" + scratch.write("case.lcs", file) + "\"\n" + cards + ".end\n");
}

using Function = std::function<double(double)>;

/// Signals, in order, against functions of time; of values of order one.
Measured against(const DeckRun& run, const std::vector<Function>& functions) {
  Measured result;
  result.problem = problem_of(run);
  if (!result.problem.empty()) return result;
  for (const auto& row : run.rows)
    for (std::size_t k = 0; k < functions.size(); ++k) raise(result.value, std::abs(row[k + 1] - functions[k](row[0])));
  return result;
}

void measure_event(const DeckRun& run, double time, Measured& result) {
  const auto* row = event_near(run, time);
  if (row == nullptr)
    result.problem = fmt::format("no event at {}", time);
  else
    raise(result.event_time, std::abs((*row)[0] - time) / run.stop);
}

/// The stop touched at x1 = 0: x3 < 0 jumps to zero, then the first of x3, x2, x4 that is not zero decides: positive, the cart leaves; else it
/// stays, with force −x2 (paper, section 3 and eq. (4.21)).
Measured sign_patterns() {
  Measured result;
  int wrong = 0;
  for (const int x2 : {-1, 0, 1})
    for (const int x3 : {-1, 0, 1})
      for (const int x4 : {-1, 0, 1}) {
        const auto file = fmt::format("A\n0 0 1 0\n0 0 0 1\n-2 1 0 0\n1 -1 0 0\nB\n0\n0\n1\n0\nC\n1 0 0 0\nx0\n0 {} {} {}\n", x2, x3, x4);
        const DeckRun run = run_raw(file, ".tran 1e-3 1e-3\n");
        if (!problem_of(run).empty()) return failed(problem_of(run));
        const int jumped = std::max(x3, 0), decisive = jumped != 0 ? jumped : x2 != 0 ? x2 : x4;
        const auto& start = run.rows.front();
        raise(result.value, std::abs(start[3] - jumped));
        if (decisive < 0) raise(result.value, std::abs(start[5] + x2));
        const bool left = run.rows.back()[6] > decided * decided;
        if (left != (decisive > 0)) ++wrong;
      }
  result.outcome = fmt::format("{} of 27 decided otherwise", wrong);
  if (wrong > 0) result.problem = result.outcome;
  return result;
}

Measured three_solutions() {
  const DeckRun run = run_deck(folder("tests/hard/case08.net"));
  if (run.answer.outcome == engine::Outcome::not_unique && run.answer.time == 0.0) return told("at t = 0: not unique");
  return failed("not reported");
}

Measured dead_zone() {
  Measured result = against(run_deck(folder("netlists/paper/relay_deadzone.net")),
                            {[](double t) { return std::max(1.0 - t, 0.5); }, [](double t) { return t < 0.5 ? 1.0 : 0.0; }});
  measure_event(run_deck(folder("netlists/paper/relay_deadzone.net"), true), 0.5, result);
  return result;
}

Measured twisting() {
  const DeckRun run = run_text(twisting_deck("", "0.25 3"), true);
  Measured result = against(run, {[](double t) { return twisted(t).x; }, [](double t) { return twisted(t).v; }});
  measure_event(run, 1.0 + 2.0 / std::sqrt(3.0), result);
  return result;
}

Measured corner() {
  return against(run_deck(folder("docs/concepts/corner.net")),
                 {[](double) { return 0.0; }, [](double t) { return 0.2 * t; }, [](double) { return 0.0; }, [](double) { return 0.2; }});
}

Measured support() {
  const auto rest = [](double t) { return 1.5 * t * t; };
  return against(
      run_raw("A\n0 1 0 0\n0 0 0 0\n0 0 0 1\n0 0 0 0\nB\n0\n1\n0\n0\nC\n1 0 -1 0\nE\n0\n2\n0\n3\nw\nDC 1\nF\n0\n", ".tran 0.25 1\n"),
      {rest});
}

Measured negative_matrix() {
  const auto outcome = [](const char* level) {
    return run_raw(std::string("D\n-1\nF\n1\nw\nDC ") + level + "\n", ".tran 0.5 1\n").answer.outcome;
  };
  if (outcome("1") == engine::Outcome::not_unique && outcome("-1") == engine::Outcome::no_solution)
    return told("q > 0: not unique; q < 0: none");
  return failed("not reported");
}

Measured cycling_matrix() {
  const auto third = [](double) { return 1.0 / 3.0; };
  return against(run_raw("D\n1 0 2\n2 1 0\n0 2 1\nF\n-1\n-1\n-1\nw\nDC 1\n", ".save u(s,1) u(s,2) u(s,3)\n.tran 0.5 1\n"),
                 {third, third, third});
}

}  // namespace

const std::vector<HardCase>& hard_cases() {
  static const std::string decks = "regression/hard_cases", model = "model/selection", engine = "engine/hard_circuits";
  static const std::vector<HardCase> cases{
      {1, "two carts, the stop is hit at the start", decks + ", regression/blocks"},
      {2, "carts at rest, force t", decks},
      {3, "carts: a jump, then free", decks + ", " + model},
      {4, "carts: a push of 10⁻⁴ decides", decks + ", " + model},
      {5, "27 sign patterns at the stop", model},
      {6, "triple integrator: impulse of higher order", decks + ", " + model + ", regression/blocks"},
      {7, "x' = t − sgn x slides", decks},
      {8, "x' = sgn x from 0: three solutions", decks + ", " + model},
      {9, "x' = −sgn x comes to rest", decks + ", " + model},
      {10, "saturation", decks},
      {11, "relay with dead zone", "regression/paper"},
      {12, "Coulomb friction", decks},
      {13, "twisting: infinitely many events", "regression/accumulation, " + model},
      {14, "obtuse corner", model},
      {15, "a support that accelerates", "regression/blocks, " + model},
      {16, "RL rectifier", decks + ", " + engine},
      {17, "peak detector", decks + ", " + engine},
      {18, "LC and diode", decks + ", " + engine},
      {19, "a diode joins two charged capacitors", decks + ", " + engine + ", regression/jumps"},
      {20, "1 pF onto 1 µF", decks + ", " + engine},
      {21, "chain of diodes and capacitors", decks + ", " + engine},
      {22, "two inductors, one freewheeling diode", decks + ", " + engine + ", regression/jumps"},
      {23, "commutation", decks + ", " + engine},
      {24, "capacitive divider, a step", decks + ", " + engine},
      {25, "ring of diodes", decks + ", " + engine},
      {26, "two diodes in series", decks + ", " + engine},
      {27, "two diodes in parallel", decks + ", " + engine},
      {28, "bridge, floating secondary", decks + ", " + engine},
      {29, "voltage doubler", decks + ", " + engine},
      {30, "buck, discontinuous", decks},
      {31, "a stop barely reached, or not", decks + ", engine/grazing"},
      {32, "two crossings a nanosecond apart", decks + ", engine/grazing"},
      {33, "three equal RC sections", decks + ", " + engine},
      {34, "y = q − u", "regression/blocks, lcp/lemke, lcp/solve, " + model},
      {35, "P-matrix on which Newton cycles", "regression/blocks, lcp/lemke, lcp/solve"},
  };
  return cases;
}

Measured measure(const HardCase& hard_case) {
  switch (hard_case.number) {
    case 5:
      return sign_patterns();
    case 8:
      return three_solutions();
    case 11:
      return dead_zone();
    case 13:
      return twisting();
    case 14:
      return corner();
    case 15:
      return support();
    case 34:
      return negative_matrix();
    case 35:
      return cycling_matrix();
    default:
      return measure_decks(hard_case.number);
  }
}

}  // namespace pwlsim::test
