#include "analysis/recorded_run.hpp"

#include <optional>
#include <utility>

#include "analysis/derivative_table.hpp"
#include "analysis/sensitivity_inputs.hpp"
#include "steady/carried_trace.hpp"

namespace pwlsim::analysis {
namespace {

using circuit::Compiled;

/// Of a run: so far it goes on, so that what happens at its end is seen.
constexpr double beyond_end = 1e-9;

/// A model, and where its run begins.
struct Beginning {
  std::shared_ptr<const engine::ExactModel> model;
  engine::RunStart start;  ///< where the deck says
  engine::RunState state;
  std::string failure;
};

class Recorder {
 public:
  Recorder(const Compiled& compiled, const SteadyState* orbit, const std::atomic<int>& interrupt, const measure::Record* known)
      : compiled_(compiled),
        transient_(*compiled.analyses.transient),
        orbit_(orbit),
        known_(known),
        request_(request_of(compiled.analyses, {})) {
    request_.interrupt = &interrupt;
  }

  RecordedRun run() {
    model::Network network = compiled_.network;
    run_.inputs = add_inputs(*compiled_.analyses.sensitivities, compiled_.network, network);
    Beginning own = begin(network);
    run_.model = own.model;
    run_.start = own.start;
    run_.failure = own.failure;
    if (!run_.failure.empty()) return std::move(run_);
    if (!record_without_inputs() && !record(own, network.signals.size()))
      run_.failure = *request_.interrupt != 0 ? interrupted_derivative : "the run did not complete";
    return std::move(run_);
  }

 private:
  Beginning begin(const model::Network& network) const {
    Beginning result;
    Diagnostics diagnostics;
    result.model = engine::prepare(network, diagnostics);
    if (!result.model) {
      result.failure = "the circuit with its parameters as inputs has no model";
      return result;
    }
    if (orbit_ != nullptr) {
      const auto there = state_in(*result.model, *orbit_);
      if (!there) result.failure = "the parts of the circuit differ between the run and the orbit";
      if (there) result.state = *there;
      return result;
    }
    result.start = transient_.use_initial_conditions ? engine::start_from_initial_values(*result.model)
                                                     : engine::start_from_operating_point(*result.model);
    if (result.start.answer.outcome != engine::Outcome::completed) result.failure = "the run has no start";
    result.state = result.start;
    return result;
  }

  /// The inputs are zero: the run is that of the model without them.
  bool record_without_inputs() {
    const Beginning plain = begin(compiled_.network);
    if (!plain.failure.empty() || !record(plain, compiled_.network.signals.size())) return false;
    run_.selectors = std::make_shared<engine::Selectors>(*run_.model, request_.non_unique);
    if (!steady::carry(run_.trace, *plain.model, *run_.model, *run_.selectors, transient_.stop.seconds)) return false;
    run_.march.reset();
    return true;
  }

  bool record(const Beginning& from, std::size_t signals) {
    run_.march = std::make_shared<engine::March>(*from.model, engine::March::Options{request_.non_unique, request_.interrupt});
    const double start = transient_.start.seconds, stop = transient_.stop.seconds;
    const bool is_measured = known_ != nullptr && known_->values.size() == compiled_.measurements.list.size();
    if (is_measured) {
      run_.measured = pass_of(compiled_.measurements, *known_, start, stop);
    } else if (run_.measured.measurements == nullptr) {
      const auto simulate = [&](const engine::Request& asked, engine::RowSink& sink) { return run_.march->run(from.state, asked, sink); };
      engine::Request request = request_;
      request.unsaved_signals = signals;
      run_.measured = measure_run(compiled_.measurements, simulate, request, start, stop, 0.0, nullptr);
    }
    if (!take_trace(from.state, stop * (1.0 + beyond_end), is_measured) && !take_trace(from.state, stop, is_measured)) return false;
    steady::end_at(run_.trace, stop);
    return true;
  }

  /// The run up to `stop`, and what of its pieces is needed, where that is not known. False where it did not complete.
  bool take_trace(const engine::RunState& from, double stop, bool takes_pieces) {
    steady::TraceRecorder recorder(from.on);
    engine::RunState end = from;
    std::optional<PieceLook> look;
    if (takes_pieces) {
      run_.measured.pieces.clear();
      run_.measured.extremes.clear();
      look.emplace(run_.measured);
    }
    const engine::Answer answer = run_.march->advance(end, stop, &recorder, look ? look->probes() : engine::Probes{});
    run_.trace = recorder.take();
    if (look) look->finish();
    return answer.outcome == engine::Outcome::completed;
  }

  const Compiled& compiled_;
  const circuit::TransientAnalysis& transient_;
  const SteadyState* orbit_;
  const measure::Record* known_;  ///< null: the run has not been measured
  engine::Request request_;
  RecordedRun run_;
};

}  // namespace

RecordedRun record_run(const Compiled& compiled, const SteadyState* orbit, const std::atomic<int>& interrupt,
                       const measure::Record* known) {
  return Recorder(compiled, orbit, interrupt, known).run();
}

}  // namespace pwlsim::analysis
