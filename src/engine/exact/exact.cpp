#include "engine/exact/exact.hpp"

#include "engine/exact/start.hpp"
#include "engine/exact/transient.hpp"

namespace pwlsim::engine {

Answer run(const ExactModel& model, const Request& request, RowSink& sink) {
  const auto clock = std::chrono::steady_clock::now();
  Start start = request.use_initial_conditions ? start_from_initial_values(model) : start_from_operating_point(model);
  if (start.answer.outcome != Outcome::completed) return start.answer;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
  Transient transient(model, request, sink);
  Answer answer = transient.run(start);
  answer.statistics.seconds_simulate += seconds;
  answer.remarks.insert(answer.remarks.begin(), start.answer.remarks.begin(), start.answer.remarks.end());
  return answer;
}

OperatingPoint operating_point(const ExactModel& model) {
  Start start = start_from_operating_point(model);
  OperatingPoint result;
  result.values.assign(model.signal_names.size(), 0.0);
  for (std::size_t i = 0; i < start.signals.size(); ++i) {
    const model::System& s = model.islands[i].extraction.system;
    for (std::size_t k = 0; k < s.outputs.size(); ++k) result.values[static_cast<std::size_t>(s.output_signal[k])] += start.signals[i][k];
  }
  start.answer.remarks.insert(start.answer.remarks.begin(), model.remarks.begin(), model.remarks.end());
  result.answer = std::move(start.answer);
  return result;
}

}  // namespace pwlsim::engine
