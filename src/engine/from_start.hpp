#pragma once
/// A run from where it starts, the same way for every engine.

#include <fmt/format.h>

#include <chrono>

#include "engine/remarks.hpp"
#include "engine/run.hpp"

namespace pwlsim::engine {

/// From the DC operating point, or with uic from initial values. Where there is no operating point the run starts as with uic and says so; where it
/// cannot go on from there either, the missing operating point is its error.
/// `start_at(bool uic)`: a start with its Answer `answer`; `run_from(request, start)`: the run.
template <class StartAt, class RunFrom>
Answer run_from_start(const Request& wanted, StartAt start_at, RunFrom run_from) {
  const auto clock = std::chrono::steady_clock::now();
  Request request = wanted;
  auto start = start_at(request.use_initial_conditions);
  Answer missing;
  if (!request.use_initial_conditions && start.answer.id == no_operating_point) {
    missing = start.answer;
    request.use_initial_conditions = true;
    start = start_at(true);
    start.answer.remarks.insert(start.answer.remarks.begin(), starts_without_operating_point(missing.message));
  }
  if (start.answer.outcome != Outcome::completed) return start.answer;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
  Answer answer = run_from(request, start);
  if (!missing.id.empty() && answer.outcome == Outcome::no_solution && answer.time <= 0.0) {
    answer.id = missing.id;
    answer.message = fmt::format("{}; and as with uic {}", missing.message, answer.message);
    return answer;
  }
  answer.statistics.seconds_simulate += seconds;
  answer.remarks.insert(answer.remarks.begin(), start.answer.remarks.begin(), start.answer.remarks.end());
  return answer;
}

}  // namespace pwlsim::engine
