#pragma once
/// Short decks in a test, run to their end and compared with closed forms.

#include <catch2/catch.hpp>
#include <functional>
#include <string>

#include "regression/deck_run.hpp"

namespace pwlsim::test {

constexpr double exact = 1e-11;  ///< of the largest value of a signal

/// Cards without a title; the test ends where the run does not come to its end, or has something to say.
inline DeckRun run_cards(const std::string& cards, bool events = false) {
  DeckRun run = run_text("t\n" + cards, events);
  INFO(run.messages << run.answer.message);
  REQUIRE(run.messages.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  return run;
}

/// The signal saved as number k, from 1, against a function of time; `size` is its largest value.
inline void check_signal(const DeckRun& run, std::size_t k, double size, const std::function<double(double)>& expected) {
  for (const auto& row : run.rows) {
    INFO(run.signals[k - 1] << " at t = " << row[0]);
    CHECK(row[k] == Approx(expected(row[0])).margin(exact * size));
  }
}

}  // namespace pwlsim::test
