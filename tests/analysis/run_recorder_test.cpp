#include "analysis/run_recorder.hpp"

#include <catch2/catch.hpp>

#include "analysis/run_figure.hpp"

using namespace pwlsim;
using analysis::RunRecorder;
using Numbers = std::vector<double>;
using Words = std::vector<std::string>;
using Flags = std::vector<char>;

namespace {

const engine::Event at(double time) { return {time, false, true, false}; }

}  // namespace

TEST_CASE("a lane holds the times at which its port changed", "[unit]") {
  RunRecorder recorder(0.0, 1.0, 1);
  recorder.begin(Words{"D1", "S1"}, Flags{1, 0});
  recorder.happened(at(0.25), Flags{0, 0});
  recorder.happened(at(0.5), Flags{1, 1});
  recorder.end(1.0);
  const auto lanes = recorder.lanes();
  REQUIRE(lanes.size() == 2);
  CHECK(lanes[0].times == Numbers{0.0, 0.25, 0.5});
  CHECK(lanes[0].shares == Numbers{1.0, 0.0, 1.0});
  CHECK(lanes[1].times == Numbers{0.0, 0.5});
  CHECK(lanes[1].shares == Numbers{0.0, 1.0});
  REQUIRE(recorder.told().size() == 2);
  CHECK(recorder.told()[1].changes == Words{"D1 on", "S1 on"});
}

TEST_CASE("a run whose rows begin later keeps the positions of then", "[unit]") {
  RunRecorder recorder(1.0, 2.0, 1);
  recorder.begin(Words{"D1"}, Flags{0});
  recorder.happened(at(0.5), Flags{1});
  recorder.happened(at(1.5), Flags{0});
  recorder.end(2.0);
  CHECK(recorder.lanes()[0].times == Numbers{1.0, 1.5});
  CHECK(recorder.lanes()[0].shares == Numbers{1.0, 0.0});
  CHECK(recorder.event_count() == 1);
}

TEST_CASE("ports of one element are told apart", "[unit]") {
  RunRecorder recorder(0.0, 1.0, 1);
  recorder.begin(Words{"D1", "D1"}, Flags{0, 0});
  recorder.end(1.0);
  CHECK(recorder.lanes()[1].name == "D1 (2)");
}

TEST_CASE("millions of events are kept as shares of time, in bounded memory", "[unit]") {
  RunRecorder recorder(0.0, 1.0, 1);
  recorder.begin(Words{"D1", "D2"}, Flags{1, 0});
  constexpr int periods = 1'000'000;
  for (int k = 0; k < periods; ++k) {  // on for a quarter of each period
    recorder.happened(at((k + 0.25) / periods), Flags{0, 0});
    recorder.happened(at((k + 1.0) / periods), Flags{1, 0});
  }
  recorder.end(1.0);
  CHECK(recorder.event_count() == 2 * periods);
  CHECK(recorder.events().size() < 25'000);
  CHECK(recorder.told().size() == RunRecorder::most_told);
  const auto lanes = recorder.lanes();
  CHECK(lanes[0].times.size() <= 4000);
  for (const double share : lanes[0].shares) REQUIRE(share == Approx(0.25).epsilon(1e-3));
  CHECK(lanes[1].shares == Numbers{0.0});
}

TEST_CASE("recorders that share the memory keep fewer events, and all of them while these are few", "[unit]") {
  const auto kept = [](int events, std::size_t sharers) {
    RunRecorder recorder(0.0, 1.0, 1, sharers);
    recorder.begin(Words{"D1"}, Flags{0});
    for (int k = 0; k < events; ++k) recorder.happened(at((k + 0.5) / events), Flags{k % 2 == 0 ? char{1} : char{0}});
    return recorder.events().size();
  };
  CHECK(kept(5000, 12) == 5000);
  CHECK(kept(20'000, 1) == 20'000);
  CHECK(kept(20'000, 12) == 4000);
}

TEST_CASE("signals share panels by unit, six at most", "[unit]") {
  const Words names{"v(a)", "i(L1)", "v(b)", "v(c)", "x(s,1)", "v(d)", "v(e)", "v(f)", "v(g)"};
  CHECK(analysis::panels_of(names) == std::vector<std::vector<std::size_t>>{{0, 2, 3, 5, 6, 7}, {8}, {1}, {4}});
}

TEST_CASE("a picture says how many signals it does not show", "[unit]") {
  Words names;
  for (int k = 0; k < 60; ++k) names.push_back("v(" + std::to_string(k) + ")");
  RunRecorder recorder(0.0, 1.0, names.size());
  const Numbers values(60 * linalg::legendre_points, 0.5);
  recorder.take_piece({0.0, 1.0, 0.0, 1.0, values});
  const waveform::Figure figure = analysis::run_figure("many", names, recorder);
  CHECK(figure.panels.size() == 8);
  CHECK(figure.title == "many (48 of 60 signals)");
}
