/// A run that goes wrong must notice. Events are passed over on purpose, and states disturbed, one a run.

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "regression/deck_run.hpp"

namespace {

using pwlsim::engine::Outcome;
using pwlsim::engine::Request;
using pwlsim::test::DeckRun;
using pwlsim::test::run_deck_with_faults;

constexpr double doubtful = 1e-6;  ///< residual from which on a run carries W-certificate
constexpr int faults_of_each = 100;
constexpr double disturbance = 1e-3;

double certificate(const DeckRun& run) { return std::max(run.answer.certificate.complementarity, run.answer.certificate.kcl_kvl); }

/// The certificate doubts the run, or it has ended with an error.
bool is_noticed(const DeckRun& run) { return run.answer.outcome != Outcome::completed || certificate(run) > doubtful; }

/// Largest difference of a signal over all rows, against its largest value.
double difference_of_common_rows(const DeckRun& right, const DeckRun& other) {
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

std::string any_deck() {
  const char* name = GENERATE("halfwave", "fullwave", "fullwave_centre_tap", "supplied_bridge", "buck_dcm", "boost", "six_pulse", "flyback",
                              "cockcroft_walton", "bridge_filter");
  return std::string(PWLSIM_SOURCE_DIR "/netlists/") + name + ".net";
}

/// Each fault is noticed, or changes no row: behind the last event, at a port that only touches zero, in a state that is zero.
template <typename Fault>
void check_all_are_noticed(const Fault& fault) {
  const std::string path = any_deck();
  const DeckRun right = run_deck_with_faults(path, {});
  REQUIRE(right.answer.outcome == Outcome::completed);
  REQUIRE(certificate(right) < 1e-9);
  int noticed = 0;
  for (std::uint64_t number = 1; number <= faults_of_each; ++number) {
    const DeckRun run = run_deck_with_faults(path, fault(number));
    if (is_noticed(run)) {
      ++noticed;
      continue;
    }
    INFO(path << ", fault " << number);
    CHECK(difference_of_common_rows(right, run) <= doubtful);
  }
  INFO(path << ": " << noticed << " of " << faults_of_each);
  CHECK(noticed > 0);
}

}  // namespace

TEST_CASE("an event that is passed over is noticed, or changes nothing", "[regression]") {
  check_all_are_noticed([](std::uint64_t number) {
    Request::Faults faults;
    faults.dropped_event = number;
    return faults;
  });
}

TEST_CASE("a state that changes without an impulse is noticed, or changes nothing", "[regression]") {
  check_all_are_noticed([](std::uint64_t number) {
    Request::Faults faults;
    faults.disturbed_segment = number;
    faults.disturbance = disturbance;
    return faults;
  });
}
