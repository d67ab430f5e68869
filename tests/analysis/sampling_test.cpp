#include "analysis/sampling.hpp"

#include <catch2/catch.hpp>

using namespace pwlsim;
using Numbers = std::vector<double>;

namespace {

circuit::Analyses analyses() {
  circuit::TransientAnalysis transient;
  transient.step = {0.5, "0.5"};
  transient.stop = {1.0, "1"};
  circuit::Analyses result;
  result.transient = transient;
  return result;
}

/// Two signals, t and 1 - t; with events a second row at 0.5.
engine::Answer ramps(const engine::Request& request, engine::RowSink& sink) {
  const auto write = [&](double time) {
    const double row[] = {time, time, 1.0 - time};
    (void)sink.write(row, 1);
  };
  for (std::uint64_t k = 0; k < request.grid.rows; ++k) {
    write(request.grid.time(k));
    if (request.events && request.grid.time(k) == 0.5) write(0.5);
  }
  engine::Answer answer;
  answer.time = request.stop;
  return answer;
}

}  // namespace

TEST_CASE("a run is kept at the times asked for, a column a signal", "[unit]") {
  const Numbers times{0.25, 0.75};
  const analysis::SampledRun run = analysis::sample(analyses(), 2, ramps, times);
  CHECK(run.times == times);
  CHECK(run.columns == std::vector<Numbers>{{0.25, 0.75}, {0.75, 0.25}});
  CHECK(run.answer.time == 1.0);
  CHECK(analysis::repeated_times(run).empty());
}

TEST_CASE("a run on the deck's own grid has the deck's rows", "[unit]") {
  CHECK(analysis::sample_grid(analyses(), 2, ramps).times == Numbers{0.0, 0.5, 1.0});
}

TEST_CASE("times at which two rows stand are those of events", "[unit]") {
  analysis::RunControl control;
  control.events = true;
  const analysis::SampledRun run = analysis::sample_grid(analyses(), 2, ramps, control);
  CHECK(run.times == Numbers{0.0, 0.5, 0.5, 1.0});
  CHECK(analysis::repeated_times(run) == Numbers{0.5});
}
