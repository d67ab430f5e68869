#include "analysis/prepared_engine.hpp"

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <string>

#include "engine/sparse/sparse.hpp"
#include "support/circuit.hpp"

using namespace pwlsim;

namespace {

/// A rectifier before an RC ladder whose part is too large for dense modes.
model::Network long_ladder() {
  test::TestCircuit c;
  c.v("s", "0", test::sine(1.0, 1e3));
  c.d("s", "n0");
  for (std::size_t k = 0; k <= engine::sparse::dense_limit; ++k) {
    const std::string here = "n" + std::to_string(k), next = "n" + std::to_string(k + 1);
    c.r(here, next, 1.0);
    c.c(next, "0", 1e-6);
  }
  c.save_v("n1");
  return c.network();
}

struct CountedRows : engine::RowSink {
  bool write(std::span<const double>, std::size_t count) override {
    rows += count;
    return true;
  }
  std::size_t rows = 0;
};

}  // namespace

TEST_CASE("an engine that is prepared when it is needed names what the circuit lacks", "[unit]") {
  test::TestCircuit c;
  c.v("a", "0", model::Dc{1.0});
  c.r("a", "0", 1.0);
  c.v("a", "0", model::Dc{2.0});
  c.save_v("a");
  const analysis::PreparedEngine engine = analysis::exact_engine_when_needed(c.network());
  engine::Request request;
  request.stop = 1.0;
  analysis::NoRows rows;
  for (int round = 0; round < 2; ++round) {
    const engine::Answer answer = engine.simulate(request, rows);
    CHECK(answer.outcome == engine::Outcome::no_solution);
    CHECK(answer.id == "E-source-loop");
    CHECK_FALSE(answer.message.empty());
    CHECK(engine.operating_point().answer.id == "E-source-loop");
  }
}

// The request has no flag, as in a step that does not look at it.
TEST_CASE("rows of a trial that does not end after a signal are kept", "[unit]") {
  static std::atomic<int> interrupt = 0;
  interrupt = 0;
  const model::Network network = long_ladder();
  REQUIRE(analysis::runs_by_segments(network, analysis::EngineChoice::automatic));
  Diagnostics diagnostics;
  const analysis::PreparedEngine engine =
      analysis::prepare_engine(network, analysis::EngineChoice::automatic, engine::sparse::default_tolerance, diagnostics, interrupt);
  REQUIRE(engine.simulate);
  engine::Request request;
  request.stop = 1e6;
  request.grid = {[](std::uint64_t k) { return 1e-3 * static_cast<double>(k); }, 1'000'000'000};
  const auto begin = std::chrono::steady_clock::now();
  request.progress = [begin](double) {
    if (std::chrono::steady_clock::now() - begin > std::chrono::milliseconds(500)) interrupt = 15;
  };
  CountedRows rows;
  const engine::Answer answer = engine.simulate(request, rows);
  CHECK(answer.outcome == engine::Outcome::interrupted);
  CHECK(rows.rows > 1);
}
