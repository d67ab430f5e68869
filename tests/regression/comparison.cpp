#include "regression/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "regression/deck_run.hpp"
#include "regression/reference.hpp"

namespace pwlsim::test {
namespace {

constexpr double certificate_bound = 1e-9;  ///< every residual of a run, relative
/// Of the run. Where impulses act: the exact value at the instant itself is another on either side.
constexpr double instant_margin = 1e-12;

/// The two rows that --events writes at one instant.
struct Event {
  double time = 0.0;
  const std::vector<double>* after = nullptr;
};

std::vector<Event> events_of(const DeckRun& run) {
  std::vector<Event> events;
  for (std::size_t i = 1; i < run.rows.size(); ++i)
    if (run.rows[i][0] == run.rows[i - 1][0] && run.rows[i][0] > 0.0) events.push_back({run.rows[i][0], &run.rows[i]});
  return events;
}

void check_completed(const DeckRun& run) {
  INFO(run.messages << run.answer.id << " " << run.answer.message);
  REQUIRE(run.messages.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  REQUIRE(run.answer.time == run.stop);
}

void check_certificate(const engine::Certificate& certificate) {
  CHECK(certificate.points_checked > 0);
  CHECK(certificate.complementarity <= certificate_bound);
  CHECK(certificate.kcl_kvl <= certificate_bound);
  CHECK(certificate.energy <= certificate_bound);
}

/// Worst error over all rows, signal by signal.
void check_rows(const DeckRun& run, const Reference& reference, double bound) {
  for (const auto& expected : reference.rows) {
    INFO("reference row at t = " << expected[0]);
    REQUIRE(run.row_at(expected[0]) != nullptr);
  }
  for (std::size_t signal = 0; signal < reference.signals.size(); ++signal) {
    double worst = 0.0, at = 0.0;
    for (const auto& expected : reference.rows) {
      const double error = std::abs((*run.row_at(expected[0]))[signal + 1] - expected[signal + 1]);
      if (error <= worst) continue;
      worst = error;
      at = expected[0];
    }
    INFO(reference.signals[signal] << " is worst at t = " << at << ", maximum " << reference.maximum(signal));
    CHECK(worst / reference.maximum(signal) <= bound);
  }
}

/// The event of the reference nearest to `time`; null where there is none within `tolerance`.
const ReferenceEvent* nearest(const Reference& reference, double time, double tolerance) {
  const ReferenceEvent* best = nullptr;
  for (const auto& event : reference.events)
    if (event.counts() && std::abs(event.time - time) <= tolerance && (!best || std::abs(event.time - time) < std::abs(best->time - time)))
      best = &event;
  return best;
}

/// `touch`: the deck only touches a stop, and a touch may count as an event or not.
void check_event_times(const std::vector<Event>& events, const Reference& reference, double tolerance, bool touch) {
  std::string extra, missing;
  for (const Event& event : events)
    if (!nearest(reference, event.time, tolerance)) extra += fmt::format(" {:.17g}", event.time);
  for (const auto& expected : reference.events) {
    if (!expected.counts()) continue;
    const bool found =
        std::any_of(events.begin(), events.end(), [&](const Event& event) { return std::abs(event.time - expected.time) <= tolerance; });
    if (!found) missing += fmt::format(" {:.17g} ({})", expected.time, expected.what);
  }
  INFO("times within " << tolerance << " s; not in the reference:" << extra << "; missing:" << missing);
  if (!touch) CHECK(extra.empty());
  CHECK(missing.empty());
}

void check_values_after_events(const std::vector<Event>& events, const Reference& reference, const Bounds& bounds, double tolerance) {
  double worst = 0.0, at = 0.0;
  std::size_t worst_signal = 0;
  for (const Event& event : events) {
    const ReferenceEvent* expected = nearest(reference, event.time, tolerance);
    if (!expected) continue;
    for (std::size_t signal = 0; signal < reference.signals.size(); ++signal) {
      const double error = std::abs((*event.after)[signal + 1] - expected->after[signal]) / reference.maximum(signal);
      if (error <= worst) continue;
      worst = error;
      at = event.time;
      worst_signal = signal;
    }
  }
  INFO("just after t = " << at << ", " << reference.signals[worst_signal]);
  CHECK(worst <= bounds.value);
}

}  // namespace

std::vector<std::filesystem::path> decks_in(const std::string& folder) {
  std::vector<std::filesystem::path> decks;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(PWLSIM_SOURCE_DIR) / folder))
    if (entry.path().extension() == ".net") decks.push_back(entry.path());
  REQUIRE(!decks.empty());
  std::sort(decks.begin(), decks.end());
  return decks;
}

void compare_with_reference(const std::filesystem::path& deck, const Bounds& bounds) {
  const Reference reference = read_reference(deck.stem().string());
  const DeckRun plain = run_deck(deck);
  check_completed(plain);
  REQUIRE(plain.signals == reference.signals);
  check_certificate(plain.answer.certificate);
  check_rows(plain, reference, bounds.value);

  const DeckRun with_events = run_deck(deck, true);
  check_completed(with_events);
  const std::vector<Event> events = events_of(with_events);
  CHECK(plain.answer.statistics.events == events.size());
  const double tolerance = bounds.time * plain.stop;
  check_event_times(events, reference, tolerance, bounds.touch);
  check_values_after_events(events, reference, bounds, tolerance);
}

double worst_error(const DeckRun& run, const Reference& reference) {
  double worst = 0.0;
  for (const auto& expected : reference.rows) {
    const bool at_event = std::any_of(reference.events.begin(), reference.events.end(),
                                      [&](const auto& event) { return std::abs(event.time - expected[0]) < instant_margin * run.stop; });
    if (at_event) continue;
    const auto* row = run.row_at(expected[0]);
    if (!row) return INFINITY;
    for (std::size_t signal = 0; signal < reference.signals.size(); ++signal)
      worst = std::max(worst, std::abs((*row)[signal + 1] - expected[signal + 1]) / reference.maximum(signal));
  }
  return worst;
}

BothRuns run_both(const std::string& deck) {
  BothRuns runs{run_text(deck), run_text_segments(deck)};
  REQUIRE(runs.modes.answer.outcome == engine::Outcome::completed);
  INFO(runs.segments.answer.id << " " << runs.segments.answer.message);
  REQUIRE(runs.segments.answer.outcome == engine::Outcome::completed);
  return runs;
}

double largest_difference(const DeckRun& one, const DeckRun& other, double least) {
  REQUIRE(one.rows.size() == other.rows.size());
  if (one.rows.empty()) return 0.0;
  double worst = 0.0;
  for (std::size_t k = 1; k < one.rows.front().size(); ++k) {
    double largest = least, difference = 0.0;
    for (std::size_t i = 0; i < one.rows.size(); ++i) {
      largest = std::max(largest, std::abs(one.rows[i][k]));
      difference = std::max(difference, std::abs(one.rows[i][k] - other.rows[i][k]));
    }
    if (difference > 0.0) worst = std::max(worst, difference / largest);
  }
  return worst;
}

}  // namespace pwlsim::test
