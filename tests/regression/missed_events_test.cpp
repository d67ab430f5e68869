/// A run that misses an event must notice. Events are passed over on purpose, one a run.

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "regression/deck_run.hpp"

namespace {

using pwlsim::engine::Outcome;
using pwlsim::test::DeckRun;
using pwlsim::test::run_deck_without_event;

constexpr double doubtful = 1e-6;  ///< residual from which on a run carries W-certificate
constexpr int events_of_each = 100;

/// The certificate doubts the run, or it has ended with an error.
bool is_noticed(const DeckRun& run) {
  return run.answer.outcome != Outcome::completed || run.answer.certificate.complementarity > doubtful;
}

/// Largest difference of a signal over all rows, against its largest value.
double difference(const DeckRun& right, const DeckRun& other) {
  double worst = 0.0;
  for (std::size_t signal = 1; signal < right.rows.front().size(); ++signal) {
    double largest = 0.0, most = 0.0;
    for (std::size_t i = 0; i < std::min(right.rows.size(), other.rows.size()); ++i) {
      largest = std::max(largest, std::abs(right.rows[i][signal]));
      most = std::max(most, std::abs(right.rows[i][signal] - other.rows[i][signal]));
    }
    if (largest > 0.0) worst = std::max(worst, most / largest);
  }
  return worst;
}

}  // namespace

TEST_CASE("an event that is passed over is noticed, or changes nothing", "[regression]") {
  const char* name = GENERATE("halfwave", "fullwave", "fullwave_centre_tap", "supplied_bridge", "buck_dcm", "boost", "six_pulse", "flyback",
                              "cockcroft_walton", "bridge_filter");
  const std::string path = std::string(PWLSIM_SOURCE_DIR "/netlists/") + name + ".net";
  const DeckRun right = run_deck_without_event(path, 0);
  REQUIRE(right.answer.outcome == Outcome::completed);
  REQUIRE(right.answer.certificate.complementarity < 1e-9);
  int noticed = 0;
  for (int event = 1; event <= events_of_each; ++event) {
    const DeckRun run = run_deck_without_event(path, static_cast<std::uint64_t>(event));
    if (is_noticed(run)) {
      ++noticed;
      continue;
    }
    INFO(name << ", event " << event);
    CHECK(difference(right, run) <= doubtful);  // behind the last event, or a port that only touches zero
  }
  INFO(name << ": " << noticed << " of " << events_of_each);
  CHECK(noticed > 0);
}
