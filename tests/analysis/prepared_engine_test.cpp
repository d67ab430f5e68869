#include "analysis/prepared_engine.hpp"

#include <catch2/catch.hpp>

#include "support/circuit.hpp"

using namespace pwlsim;

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
