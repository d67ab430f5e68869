#include "analysis/transient.hpp"

#include <sys/resource.h>
#include <catch2/catch.hpp>
#include <csignal>
#include <limits>
#include <new>
#include <stdexcept>

#include "support/scratch.hpp"

using namespace pwlsim;
using analysis::Ending;
using analysis::TransientRun;
using test::read_file;
using test::Scratch;

namespace {

/// A deck of one signal, v(a) = 2·t, on the grid 0, 0.1, … 0.5; the engine is a few lines of the test itself.
circuit::Compiled ramp() {
  circuit::Compiled compiled;
  compiled.network.signals.push_back({"v(a,b)", {}});
  circuit::TransientAnalysis transient;
  transient.step = {0.1, "0.1"};
  transient.stop = {0.5, "0.5"};
  compiled.analyses.transient = transient;
  return compiled;
}

/// Writes the rows of the grid up to `last`, then ends with `outcome`.
analysis::Simulate engine_that_ends(std::uint64_t last, engine::Outcome outcome, std::string id = {}, std::string message = {}) {
  return [=](const engine::Request& request, engine::RowSink& sink) {
    engine::Answer answer;
    for (std::uint64_t k = 0; k <= last; ++k) {
      const double row[] = {request.grid.time(k), 2.0 * request.grid.time(k)};
      answer.time = row[0];
      if (!sink.write(row, 1)) {
        answer.outcome = engine::Outcome::sink_stopped;
        return answer;
      }
    }
    answer.outcome = outcome;
    answer.id = id;
    answer.message = message;
    return answer;
  };
}

TransientRun run(const Scratch& scratch, const analysis::Simulate& simulate, const analysis::RunControl& control = {}) {
  std::string problem;
  auto file = waveform::OutputFile::open(scratch / "a.csv", problem);
  REQUIRE(file);
  const circuit::Compiled compiled = ramp();
  const auto writer = analysis::row_writer(analysis::RowFormat::csv, compiled, *file);
  return analysis::run_transient(compiled, simulate, *file, *writer, control);
}

const std::string all_rows = "time,\"v(a,b)\"\n0,0\n0.1,0.2\n0.2,0.4\n0.3,0.6\n0.4,0.8\n0.5,1\n";
const std::string three_rows = "time,\"v(a,b)\"\n0,0\n0.1,0.2\n0.2,0.4\n";

}  // namespace

TEST_CASE("a completed run leaves the whole file", "[unit]") {
  const Scratch scratch;
  const TransientRun result = run(scratch, engine_that_ends(5, engine::Outcome::completed));
  CHECK(result.ending == Ending::completed);
  CHECK(result.message.empty());
  CHECK(result.rows == 6);
  CHECK(read_file(scratch / "a.csv") == all_rows);
  CHECK_FALSE(scratch.holds("a.csv.partial"));
}

TEST_CASE("the request carries what the deck and the command line asked", "[unit]") {
  const Scratch scratch;
  circuit::Compiled compiled = ramp();
  compiled.analyses.transient->use_initial_conditions = true;
  compiled.analyses.non_unique = circuit::NonUniqueChoice::stay;
  std::atomic<int> flag = 0;
  std::string problem;
  auto file = waveform::OutputFile::open(scratch / "a.csv", problem);
  REQUIRE(file);
  engine::Request seen;
  const auto look = [&](const engine::Request& request, engine::RowSink&) {
    seen = request;
    return engine::Answer{};
  };
  const auto writer = analysis::row_writer(analysis::RowFormat::csv, compiled, *file);
  (void)analysis::run_transient(compiled, look, *file, *writer, {true, true, [](double) {}, &flag});
  CHECK(seen.stop == 0.5);
  CHECK(seen.grid.rows == 6);
  CHECK(seen.events);
  CHECK(seen.jumps);
  CHECK(seen.use_initial_conditions);
  CHECK(seen.non_unique == engine::NonUnique::stay);
  CHECK(seen.progress);
  CHECK(seen.interrupt == &flag);
}

TEST_CASE("a run that fails keeps its rows in the completed file", "[unit]") {
  const auto outcome = GENERATE(engine::Outcome::no_solution, engine::Outcome::not_unique, engine::Outcome::accumulation);
  const Scratch scratch;
  const TransientRun result = run(scratch, engine_that_ends(2, outcome, "E-no-solution", "no solution at t = 0.25 s with D1 on"));
  CHECK(result.ending == Ending::failed);
  CHECK(result.id == "E-no-solution");
  CHECK(result.message == "no solution at t = 0.25 s with D1 on");
  CHECK(read_file(scratch / "a.csv") == three_rows);
}

TEST_CASE("an interrupted run keeps its rows and says the time", "[unit]") {
  const Scratch scratch;
  const TransientRun result = run(scratch, engine_that_ends(2, engine::Outcome::interrupted));
  CHECK(result.ending == Ending::interrupted);
  CHECK(result.message == "interrupted at t = 200 ms");
  CHECK(read_file(scratch / "a.csv") == three_rows);
}

TEST_CASE("a value beyond the range of numbers ends the run before its row", "[unit]") {
  const double beyond = GENERATE(std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN());
  const Scratch scratch;
  const auto simulate = [beyond](const engine::Request&, engine::RowSink& sink) {
    const double rows[] = {0, 0, 0.1, 0.2, 0.2, 0.4, 0.3, beyond, 0.4, 0.8};
    engine::Answer answer;
    answer.outcome = sink.write(rows, 5) ? engine::Outcome::completed : engine::Outcome::sink_stopped;
    return answer;
  };
  const TransientRun result = run(scratch, simulate);
  CHECK(result.ending == Ending::failed);
  CHECK(result.id == "E-overflow");
  CHECK(result.message.find("v(a,b) exceeds the range of numbers after t = 200 ms") == 0);
  CHECK(read_file(scratch / "a.csv") == three_rows);
}

TEST_CASE("an engine that throws keeps its rows too", "[unit]") {
  const Scratch scratch;
  const bool memory = GENERATE(true, false);
  const auto simulate = [memory](const engine::Request& request, engine::RowSink& sink) -> engine::Answer {
    (void)engine_that_ends(2, engine::Outcome::completed)(request, sink);
    if (memory) throw std::bad_alloc();
    throw std::logic_error("index out of range");
  };
  const TransientRun result = run(scratch, simulate);
  CHECK(result.ending == Ending::failed);
  CHECK(result.id == (memory ? "E-out-of-memory" : "E-internal"));
  CHECK(result.message.find("index out of range") == std::string::npos);
  CHECK(read_file(scratch / "a.csv") == three_rows);
}

TEST_CASE("a disk that fills up stops the run and names the partial file", "[unit]") {
  const Scratch scratch;
  scratch.write("a.csv", "old\n");
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  std::uint64_t blocks = 0;
  const auto simulate = [&](const engine::Request&, engine::RowSink& sink) {
    rlimit limit = before;
    limit.rlim_cur = 1 << 20;
    setrlimit(RLIMIT_FSIZE, &limit);
    const std::vector<double> block(2000, 0.123456789);
    while (blocks < 1000 && sink.write(block, 1000)) ++blocks;
    setrlimit(RLIMIT_FSIZE, &before);
    engine::Answer answer;
    answer.outcome = engine::Outcome::sink_stopped;
    return answer;
  };
  const TransientRun result = run(scratch, simulate);
  CHECK(blocks < 1000);
  CHECK(result.ending == Ending::write_failed);
  CHECK(result.message.find("File too large") != std::string::npos);
  CHECK(result.message.find(scratch / "a.csv.partial") != std::string::npos);
  CHECK(read_file(scratch / "a.csv") == "old\n");
  const std::string partial = read_file(scratch / "a.csv.partial");
  CHECK(partial.size() > 1000000);
  CHECK(partial.back() == '\n');
}
