#include "analysis/recorded_run.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "circuit/compile.hpp"
#include "netlist/load.hpp"

using namespace pwlsim;

namespace {

/// One of each kind of element, and of each way in which a state, a port or a source may be another one with inputs than without.
const std::vector<std::string> decks = {
    "peak current control\nV1 in 0 12\nS1 in a u 0 SL\nD1 0 a DI\nL1 a s 10u\nRs s o 0.1\nRe o c 20m\nC1 c 0 100u\nR1 o 0 1\n"
    "Ra o f 10k\nRb f 0 10k\nVr r 0 2.5\nE0 e 0 r f 100\nR2 f z 20k\nC2 z e 2.2n\nVk k 0 PULSE(0 9 0 0 0 0.2u 10u)\n"
    "Vm m 0 PULSE(0 1 0 9.99u 0.01u 0 10u)\nE1 n1 m s o 10\nE2 n2 e n1 0 -1\nE3 u n2 k 0 1\n.model SL SW(Ron=10m Vt=2 Vh=2)\n"
    ".model DI D(Ron=10m Vfwd=0.4)\n.tran 10u 400u uic\n.meas tran v AVG v(o)\n.sens "
    "param=V1,L1,Rs,Re,C1,R1,Vr,R2,C2,E0,E1,S1:Ron,D1:Vfwd\n"
    ".end\n",
    "a loop of capacitors, and blocking resistance\nV1 in 0 SIN(0 10 1k)\nC1 in a 1u\nC2 a 0 2u\nC3 a b 1u\nC4 b 0 1u\nD1 a 0 DX\nR1 b 0 "
    "1k\n"
    "L1 b d 1m\nR2 d 0 50\n.model DX D(Ron=1m Roff=10Meg Vfwd=0.5)\n.tran 10u 3m uic\n.meas tran v AVG v(b)\n"
    ".sens param=V1:Vamp,C1,C2,C3,R1,L1,D1:Ron,V1:Freq\n.end\n",
    "coupled inductors, from the operating point\nV1 in 0 24\nL1 in a 100u\nL2 0 b 400u\nK1 L1 L2 0.98\nS1 a 0 g 0 SX\nD1 b out DX\nC1 out "
    "0 10u\n"
    "R1 out 0 50\nVg g 0 PULSE(0 1 1u 0 0 4u 10u)\nDz a z DX\nRz z in 100\n.model SX SW(Ron=10m Vt=0.5 Vh=0)\n.model DX D(Ron=10m)\n"
    ".tran 1u 200u\n.meas tran v AVG v(out)\n.sens param=V1,L1,L2,K1,C1,R1,Vg:Ton,Rz\n.end\n",
};

}  // namespace

// With its inputs, which are zero, the circuit is the same one: each state there is what the run of that model has.
TEST_CASE("a run that is recorded without the inputs of derivatives is that with them", "[unit]") {
  constexpr double same = 1e-9;  // of the largest state of an island
  for (const std::string& deck : decks) {
    INFO(deck.substr(0, deck.find('\n')));
    SourceStore sources;
    Diagnostics diagnostics;
    const netlist::Deck parsed = netlist::parse("deck", deck, sources, diagnostics);
    const auto compiled = circuit::compile(parsed, sources, diagnostics, {.measure = true});
    REQUIRE(compiled);
    std::atomic<int> interrupt = 0;
    const analysis::RecordedRun run = analysis::record_run(*compiled, nullptr, interrupt, nullptr);
    REQUIRE(run.failure.empty());
    CHECK(run.march == nullptr);  // else the run is that with the inputs
    engine::March march(*run.model, {});
    steady::TraceRecorder recorder(run.start.on);
    engine::RunState state = run.start;
    const double stop = compiled->analyses.transient->stop.seconds;
    REQUIRE(march.advance(state, stop * (1.0 + 1e-9), &recorder).outcome == engine::Outcome::completed);
    steady::Trace with = recorder.take();
    steady::end_at(with, stop);
    REQUIRE(run.trace.steps.size() == with.steps.size());
    std::vector<double> largest(run.model->islands.size(), 0.0);
    for (const steady::TraceStep& step : with.steps)
      for (const steady::TraceSegment& segment : step.segments)
        for (int i = 0; i < segment.mode->n1; ++i)
          largest[segment.island] = std::max(largest[segment.island], std::abs(segment.y1[static_cast<std::size_t>(i)]));
    const auto is_at_rest = [&](const steady::TraceSegment& segment) {
      for (int i = 0; i < segment.mode->n1; ++i)
        if (std::abs(segment.y1[static_cast<std::size_t>(i)]) > same * largest[segment.island]) return false;
      return true;
    };
    const auto compare = [&](const steady::TraceSegment& a, const steady::TraceSegment& b) {
      REQUIRE(a.island == b.island);
      if (is_at_rest(a) && is_at_rest(b)) return;  // which diodes carry nothing is a matter of rounding
      CHECK(a.mode->active == b.mode->active);
      REQUIRE(a.y1.size() == b.y1.size());
      for (std::size_t i = 0; i < a.y1.size(); ++i) {
        CHECK(std::abs(a.y1[i] - b.y1[i]) <= same * std::max(largest[a.island], std::abs(b.y1[i])));
      }
    };
    for (std::size_t i = 0; i < with.steps.size(); ++i) {
      REQUIRE(run.trace.steps[i].segments.size() == with.steps[i].segments.size());
      REQUIRE(run.trace.steps[i].changes.size() == with.steps[i].changes.size());
      for (std::size_t k = 0; k < with.steps[i].segments.size(); ++k) compare(run.trace.steps[i].segments[k], with.steps[i].segments[k]);
      for (std::size_t k = 0; k < with.steps[i].changes.size(); ++k) {
        CHECK(run.trace.steps[i].changes[k].guard == with.steps[i].changes[k].guard);
        CHECK(run.trace.steps[i].changes[k].cause == with.steps[i].changes[k].cause);
      }
    }
  }
}
