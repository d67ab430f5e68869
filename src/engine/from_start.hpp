#pragma once
/// A run from its start, the same for every engine.

#include <fmt/format.h>

#include <chrono>

#include "engine/missing_rest.hpp"
#include "engine/remarks.hpp"
#include "engine/run.hpp"

namespace pwlsim::engine {

/// From the DC operating point, or with uic from initial values. If a part has no operating point the run reports this; if it cannot continue from there
/// either, its error includes this. `start`: with its Answer `answer` and `missing`; `run_from(start)`: the run.
template <class EngineStart, class RunFrom>
Answer run_from_start(const Request& request, std::chrono::steady_clock::time_point began, const EngineStart& start, RunFrom run_from) {
  constexpr double at_start = 1e-9;  ///< of the run
  if (start.answer.outcome != Outcome::completed) return start.answer;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  Answer answer = run_from(start);
  answer.statistics.seconds_simulate += seconds;
  answer.remarks.insert(answer.remarks.begin(), start.answer.remarks.begin(), start.answer.remarks.end());
  if (start.missing.empty()) return answer;
  if (answer.outcome == Outcome::no_solution && answer.time <= at_start * request.stop) {
    answer.id = no_operating_point;
    answer.message = fmt::format("{}; and without one {}", start.missing.text(), answer.message);
  } else {
    answer.remarks.insert(answer.remarks.begin(), starts_without_operating_point(start.missing.text()));
  }
  return answer;
}

/// The missing operating point of `start`, as the failure of an analysis that needs it.
template <class EngineStart>
Answer answer_of_operating_point(const EngineStart& start) {
  Answer answer = start.answer;
  if (start.missing.empty()) return answer;
  answer.outcome = Outcome::no_solution;
  answer.id = no_operating_point;
  answer.message = start.missing.text() + "; try uic with initial values";
  answer.elements = start.missing.elements;
  return answer;
}

}  // namespace pwlsim::engine
