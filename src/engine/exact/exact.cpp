#include "engine/exact/exact.hpp"

#include "engine/exact/start.hpp"
#include "engine/exact/transient.hpp"
#include "engine/from_start.hpp"

namespace pwlsim::engine {

Answer run(const ExactModel& model, const Request& request, RowSink& sink) {
  return run_from_start(
      request, [&](bool uic) { return uic ? start_from_initial_values(model) : start_from_operating_point(model); },
      [&](const Request& begun, const Start& start) { return Transient(model, begun, sink).run(start); });
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
  result.answer = with_cure(std::move(start.answer));
  return result;
}

}  // namespace pwlsim::engine
