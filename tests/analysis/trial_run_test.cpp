// A run that is kept until it has completed, with engines made up here.
#include "analysis/trial_run.hpp"

#include <catch2/catch.hpp>
#include <string>
#include <vector>

using namespace pwlsim;
using analysis::Simulate;

namespace {

/// All that a run tells, in order.
class Listener : public engine::RowSink, public engine::EventWatcher, public engine::PieceSink {
 public:
  bool write(std::span<const double> values, std::size_t count) override {
    for (const double value : values) heard.push_back("row " + std::to_string(static_cast<int>(value)));
    rows += count;
    return rows < most_rows;
  }
  void begin(std::span<const std::string> elements, std::span<const char> on) override {
    heard.push_back("begin " + elements[0] + (on[0] != 0 ? " on" : " off"));
  }
  void happened(const engine::Event& event, std::span<const char> on) override {
    heard.push_back("event " + std::to_string(static_cast<int>(event.time)) + (on[0] != 0 ? " on" : " off"));
  }
  void before_start(std::span<const double> values) override { heard.push_back("before " + std::to_string(static_cast<int>(values[0]))); }
  void take(const engine::Piece& piece) override {
    heard.push_back("piece " + std::to_string(static_cast<int>(piece.values[0])) + " " + std::to_string(static_cast<int>(piece.noise[0])));
  }
  void impulse(double time, std::span<const double> values) override {
    heard.push_back("impulse " + std::to_string(static_cast<int>(time)) + " " + std::to_string(static_cast<int>(values[0])));
  }

  std::vector<std::string> heard;
  std::size_t rows = 0, most_rows = 1000;
};

/// Tells one of everything, all with the number `mark`, and ends so. What it tells lies in memory that is gone afterwards.
Simulate telling(int mark, engine::Outcome outcome, int rows = 1) {
  return [=](const engine::Request& request, engine::RowSink& sink) {
    const double value = mark;
    engine::Answer answer;
    answer.outcome = engine::Outcome::sink_stopped;
    const std::vector<std::string> elements{"D" + std::to_string(mark)};
    const std::vector<char> on{1};
    request.watcher->begin(elements, on);
    request.probes.sink->before_start(std::vector<double>{value});
    for (int k = 0; k < rows; ++k) {
      std::vector<double> row{value}, points(16, value), noise{value};
      if (!sink.write(row, 1)) return answer;
      engine::Piece piece;
      piece.values = points;
      piece.noise = noise;
      request.probes.sink->take(piece);
      row[0] = points[0] = noise[0] = -1.0;
    }
    request.watcher->happened({value}, std::vector<char>{0});
    request.probes.sink->impulse(value, std::vector<double>{value});
    answer.outcome = outcome;
    answer.time = value;
    return answer;
  };
}

std::vector<std::string> all_of(int mark) {
  const std::string m = std::to_string(mark);
  return {"begin D" + m + " on", "before " + m, "row " + m, "piece " + m + " " + m, "event " + m + " off", "impulse " + m + " " + m};
}

engine::Answer run(const Simulate& simulate, Listener& listener) {
  engine::Request request;
  request.watcher = &listener;
  request.probes.sink = &listener;
  return simulate(request, listener);
}

engine::Remark why(const engine::Answer& failed) { return {"N-other", std::to_string(static_cast<int>(failed.time))}; }

}  // namespace

TEST_CASE("a trial that completes tells what it told", "[unit]") {
  Listener listener;
  const engine::Answer answer =
      run(analysis::tried_first(telling(1, engine::Outcome::completed), telling(2, engine::Outcome::completed), why), listener);
  CHECK(answer.outcome == engine::Outcome::completed);
  CHECK(answer.remarks.empty());
  CHECK(listener.heard == all_of(1));
}

TEST_CASE("a trial that finds no solution leaves nothing, and the other run says why it ran", "[unit]") {
  const auto outcome = GENERATE(engine::Outcome::no_solution, engine::Outcome::accumulation, engine::Outcome::not_unique);
  Listener listener;
  const engine::Answer answer = run(analysis::tried_first(telling(1, outcome), telling(2, engine::Outcome::completed), why), listener);
  CHECK(answer.outcome == engine::Outcome::completed);
  CHECK(answer.time == 2.0);
  REQUIRE(answer.remarks.size() == 1);
  CHECK(answer.remarks[0].text == "1");
  CHECK(listener.heard == all_of(2));
}

TEST_CASE("a trial that is interrupted keeps its rows", "[unit]") {
  Listener listener;
  const engine::Answer answer =
      run(analysis::tried_first(telling(1, engine::Outcome::interrupted), telling(2, engine::Outcome::completed), why), listener);
  CHECK(answer.outcome == engine::Outcome::interrupted);
  CHECK(listener.heard == all_of(1));
}

TEST_CASE("a trial too long to be kept passes on what it tells, and ends with its own failure", "[unit]") {
  Listener listener;
  listener.most_rows = 1'000'000;
  constexpr int many = 300'000;
  const engine::Answer answer =
      run(analysis::tried_first(telling(1, engine::Outcome::no_solution, many), telling(2, engine::Outcome::completed), why), listener);
  CHECK(answer.outcome == engine::Outcome::no_solution);
  CHECK(listener.rows == many);
  CHECK(listener.heard.front() == "begin D1 on");
  CHECK(listener.heard.back() == "impulse 1 1");
}

TEST_CASE("rows that nobody wants any more end a trial", "[unit]") {
  Listener listener;
  listener.most_rows = 1;
  const engine::Answer answer =
      run(analysis::tried_first(telling(1, engine::Outcome::completed, 3), telling(2, engine::Outcome::completed), why), listener);
  CHECK(answer.outcome == engine::Outcome::sink_stopped);
  CHECK(listener.rows == 1);
}
