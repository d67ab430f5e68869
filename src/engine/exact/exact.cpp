#include "engine/exact/exact.hpp"

#include "engine/exact/exact_run.hpp"
#include "engine/exact/start.hpp"
#include "engine/from_start.hpp"

namespace pwlsim::engine {

Answer run(const ExactModel& model, const Request& request, RowSink& sink) {
  const auto began = std::chrono::steady_clock::now();
  const RunStart start = request.use_initial_conditions ? start_from_initial_values(model) : start_from_operating_point(model);
  Selectors selectors(model, request.non_unique);
  return run_from_start(request, began, start,
                        [&](const RunState& from) { return ExactRun(model, request, sink, selectors, {}).run(from); });
}

OperatingPoint operating_point(const ExactModel& model) {
  const RunStart start = start_from_operating_point(model);
  OperatingPoint result;
  result.values.assign(model.signal_names.size(), 0.0);
  for (std::size_t i = 0; i < start.signals.size(); ++i) {
    const model::System& s = model.islands[i].extraction.system;
    for (std::size_t k = 0; k < s.outputs.size(); ++k) result.values[static_cast<std::size_t>(s.output_signal[k])] += start.signals[i][k];
  }
  result.answer = answer_of_operating_point(start);
  result.answer.remarks.insert(result.answer.remarks.begin(), model.remarks.begin(), model.remarks.end());
  return result;
}

}  // namespace pwlsim::engine
