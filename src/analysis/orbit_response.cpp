/// `.ac` of a deck, around its orbit where there is one.
#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/modulation.hpp"
#include "analysis/steady_state.hpp"

namespace pwlsim::analysis {

using circuit::Compiled;

namespace {

/// Which signals have impulses at the times that count.
class ImpulseFinder : public engine::PieceSink {
 public:
  ImpulseFinder(std::size_t signals, std::function<bool(double)> counts) : has_(signals, 0), counts_(std::move(counts)) {}
  void before_start(std::span<const double>) override {}
  void take(const engine::Piece&) override {}
  void impulse(double time, std::span<const double> values) override {
    for (std::size_t k = 0; k < values.size() && counts_(time); ++k)
      if (values[k] != 0.0) has_[k] = 1;
  }
  [[nodiscard]] std::vector<int> found() const {
    std::vector<int> list;
    for (std::size_t k = 0; k < has_.size(); ++k)
      if (has_[k] != 0) list.push_back(static_cast<int>(k));
    return list;
  }

 private:
  std::vector<char> has_;
  std::function<bool(double)> counts_;
};

/// Signals of the deck that have impulses on the orbit whose size or time a small input moves: at jumps of the state, and at edges of sources where these
/// move (`with_edges`).
std::vector<int> impulsive_signals(const Compiled& compiled, const SteadyState& state, bool with_edges) {
  const auto& steps = state.orbit.trace.steps;
  const auto jumps = [](const steady::TraceStep& step) { return step.has_jump; };
  if (!with_edges && std::none_of(steps.begin(), steps.end(), jumps)) return {};
  constexpr double near = 1e-12;  // of the period
  const double period = state.orbit.period;
  const auto is_jump = [&](double time) {
    return std::any_of(steps.begin(), steps.end(), [&](const steady::TraceStep& step) {
      const double apart = std::abs(step.time - time);
      return step.has_jump && std::min(apart, period - apart) <= near * period;
    });
  };
  // Of the deck's own signals; those of the search stand behind them.
  std::vector<int> signals;
  for (std::size_t k = 0; k < compiled.network.signals.size(); ++k) signals.push_back(static_cast<int>(k));
  ImpulseFinder impulses(signals.size(), [&](double time) { return with_edges || is_jump(time); });
  engine::Request request = request_of(state.compiled.analyses, {});
  request.stop = period;
  request.use_initial_conditions = true;
  request.unsaved_signals = state.compiled.network.signals.size();
  request.probes = {signals, 0.0, period, &impulses};
  NoRows sink;
  (void)state.simulate(request, sink);
  return impulses.found();
}

}  // namespace

SmallSignalResult small_signals(const Compiled& compiled, const SteadyState& state, const std::atomic<int>* interrupt) {
  SmallSignalResult result = small_signals(compiled, *state.inputs, state.network_with_inputs(), state.model_with_inputs(),
                                           state.trace_with_inputs(), state.orbit.period, !state.common.sources.empty(), interrupt);
  // Edges that move, and samples, would need more than the impulses of jumps.
  const circuit::SmallSignalAnalysis& card = *compiled.analyses.small_signal;
  std::vector<int> impulsive = impulsive_signals(compiled, state, moves_edges(card));
  if (!moves_edges(card) && !card.sample)
    std::erase_if(impulsive, [&](int signal) {
      return std::find(result.unknown_impulses.begin(), result.unknown_impulses.end(), signal) == result.unknown_impulses.end();
    });
  if (!impulsive.empty()) leave_out_impulsive(compiled, impulsive, result);
  return result;
}

DeckResponse deck_response(const Compiled& compiled, const SteadyState* state, const std::atomic<int>* interrupt) {
  DeckResponse response;
  if (state == nullptr) {
    const LinearSmallSignals linear(compiled);
    if (!linear.id().empty()) return {{}, linear.id(), linear.message()};
    response.result = linear.result(interrupt);
    return response;
  }
  if (state->map) return {{}, "E-pss-engine", response_needs_modes};
  if (!state->inputs->id.empty()) return {{}, state->inputs->id, state->inputs->message};
  if (!state->orbit.kink.empty()) return {{}, "E-ac-no-derivative", "the orbit has no derivative: " + state->orbit.kink};
  response.result = small_signals(compiled, *state, interrupt);
  if (response.result->is_beyond_derivatives) return {{}, "E-ac-no-derivative", beyond_derivatives};
  return response;
}

}  // namespace pwlsim::analysis
