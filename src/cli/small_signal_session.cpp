#include "cli/small_signal_session.hpp"

#include <fmt/format.h>

#include "analysis/quantity.hpp"
#include "cli/output.hpp"

namespace pwlsim::cli {
namespace {

struct Failure {
  std::string id, message;
};

/// Empty where there is a response.
Failure find_response(const circuit::Compiled& compiled, analysis::RunOutcome& outcome) {
  if (!compiled.analyses.steady_state) {
    Failure failure;
    outcome.small_signal = analysis::linear_small_signals(compiled, failure.id, failure.message);
    return failure;
  }
  const analysis::SteadyState& state = *outcome.steady_state;
  if (!state.inputs->id.empty()) return {state.inputs->id, state.inputs->message};
  if (!state.orbit.kink.empty()) return {"E-ac-no-derivative", "the orbit has no derivative: " + state.orbit.kink};
  outcome.small_signal = analysis::small_signals(compiled, state);
  return {};
}

}  // namespace

int run_small_signal(const circuit::Compiled& compiled, const SourceStore& sources, waveform::OutputFile* file,
                     analysis::RunOutcome& outcome, Messages& messages) {
  const Failure failure = find_response(compiled, outcome);
  if (!failure.id.empty()) {
    outcome.small_signal.reset();
    if (compiled.analyses.steady_state || !compiled.analyses.transient) return fail(messages, Status::wrong_input, failure.id, failure.message);
    messages.report({Severity::warning, "W-ignored-card", compiled.analyses.small_signal->span, fmt::format(".ac is ignored: {}", failure.message)},
                    sources);
    return 0;
  }
  for (const double f : outcome.small_signal->singular)
    messages.report({Severity::warning,
                     "W-ac-singular",
                     {},
                     fmt::format("the response is infinite at {}: a free direction of the orbit is in resonance there", analysis::quantity(f, "Hz"))});
  if (file == nullptr) return 0;
  const int status = write_whole(*file, analysis::small_signal_csv(*outcome.small_signal), messages);
  if (status == 0) messages.remark(analysis::small_signal_summary(*outcome.small_signal, file->name()));
  return status;
}

}  // namespace pwlsim::cli
