#include "analysis/abandonable.hpp"

#include <catch2/catch.hpp>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "analysis/abandonable_run.hpp"

using namespace pwlsim;

namespace {

class Rows : public engine::RowSink {
 public:
  bool write(std::span<const double> values, std::size_t count) override {
    values_.insert(values_.end(), values.begin(), values.end());
    count_ += count;
    return true;
  }
  std::vector<double> values_;
  std::size_t count_ = 0;
};

/// What the test and the engine's thread share; either may end first.
struct Shared {
  std::atomic<bool> may_end = false, has_ended = false, was_refused = false;
};

void wait_for(const std::atomic<bool>& flag) {
  while (!flag) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace

TEST_CASE("a run that does not look at the flag is left to itself, and what it handed over before is kept", "[unit]") {
  static std::atomic<int> interrupt = 0;
  interrupt = 0;
  const auto shared = std::make_shared<Shared>();
  const auto deaf = [shared](const engine::Request&, engine::RowSink& sink) {
    const std::vector<double> first{0.0, 1.0, 0.5, 2.0}, second{1.0, 3.0};
    (void)sink.write(first, 2);
    interrupt = 15;
    wait_for(shared->may_end);
    shared->was_refused = !sink.write(second, 1);
    shared->has_ended = true;
    return engine::Answer{};
  };
  Rows rows;
  const engine::Answer answer = analysis::abandonable(deaf, interrupt)({}, rows);
  CHECK(answer.outcome == engine::Outcome::interrupted);
  CHECK(answer.time == 0.5);  // of the last row
  CHECK(analysis::any_abandoned());
  shared->may_end = true;
  wait_for(shared->has_ended);
  CHECK(shared->was_refused);
  CHECK(rows.values_ == std::vector<double>{0.0, 1.0, 0.5, 2.0});
}

TEST_CASE("a run that looks at the flag in time ends as it says", "[unit]") {
  static std::atomic<int> interrupt = 0;
  interrupt = 2;
  const auto polite = [](const engine::Request&, engine::RowSink& sink) {
    engine::Answer answer;
    const std::vector<double> row{0.25, 7.0};
    answer.time = sink.write(row, 1) ? 0.25 : 0.0;
    answer.outcome = engine::Outcome::interrupted;
    answer.message = "stopped";
    return answer;
  };
  Rows rows;
  const engine::Answer answer = analysis::abandonable(polite, interrupt)({}, rows);
  CHECK(answer.message == "stopped");
  CHECK(answer.time == 0.25);
  CHECK(rows.count_ == 1);
}

TEST_CASE("exceptions of work in a thread of its own come out", "[unit]") {
  static const std::atomic<int> interrupt = 0;
  CHECK_THROWS_AS(analysis::finished_in_time([] { throw std::bad_alloc(); }, interrupt), std::bad_alloc);
  bool done = false;
  CHECK(analysis::finished_in_time([&] { done = true; }, interrupt));
  CHECK(done);
}
