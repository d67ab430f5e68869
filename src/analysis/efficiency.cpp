#include "analysis/efficiency.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "analysis/quantity.hpp"
#include "base/names.hpp"
#include "circuit/row_step.hpp"

namespace pwlsim::analysis {
namespace {

using circuit::Measurement;
using circuit::StepKind;

bool is_named_efficiency(const std::string& name) {
  const std::string plain = without_case(name);
  return plain.rfind("eff", 0) == 0 || plain.rfind("eta", 0) == 0;
}

/// The results that a quotient takes: "a/b" and nothing else.
bool is_quotient(const circuit::MeasuredExpression& expression) {
  const auto& steps = expression.steps;
  return steps.size() == 3 && steps[0].kind == StepKind::result && steps[1].kind == StepKind::result && steps[2].operation == "/";
}

/// Where it is known without the run.
std::optional<double> time_of(const std::optional<circuit::MeasuredExpression>& time, double otherwise) {
  if (!time) return otherwise;
  if (time->steps.size() != 1 || time->steps.front().kind != StepKind::number) return std::nullopt;
  return time->steps.front().number;
}

struct Cause {
  std::string text, cure;
};

Cause cause_of(const Measurement& power, const circuit::Compiled& compiled) {
  const circuit::TransientAnalysis& transient = *compiled.analyses.transient;
  const auto from = time_of(power.from, transient.start.seconds), to = time_of(power.to, transient.stop.seconds);
  const auto slower = [](const model::Source& x, const model::Source& y) {
    const auto period = [](const model::Source& source) {
      const double length = circuit::period_of(source.function);
      return length < model::forever ? length : 0.0;
    };
    return period(x) < period(y);
  };
  const auto& sources = compiled.network.sources;
  const auto source = std::max_element(sources.begin(), sources.end(), slower);
  const std::string changes = "the energy of capacitors and inductors changes during its window";
  if (!from || !to || source == sources.end() || !(circuit::period_of(source->function) < model::forever))
    return {changes, "a later window, at steady state"};
  constexpr double whole_within = 1e-6;
  const double periods = (*to - *from) / circuit::period_of(source->function);
  if (std::abs(periods - std::round(periods)) <= whole_within * std::max(periods, 1.0)) return {changes, "a later window, at steady state"};
  return {fmt::format("its window of {} contains {:.6g} periods of {}", quantity(*to - *from, "s"), periods, source->label.name),
          fmt::format("LAST={:.0f} PERIODS OF {}", std::max(1.0, std::floor(periods)), source->label.name)};
}

}  // namespace

std::vector<Diagnostic> efficiency_warnings(const circuit::Compiled& compiled, const measure::Results& results) {
  std::vector<Diagnostic> warnings;
  const auto& list = compiled.measurements.list;
  for (const measure::Result& result : results.list) {
    if (!result.failure.empty() || !(result.value > 1.0) || !is_named_efficiency(result.name)) continue;
    const auto measurement = std::find_if(list.begin(), list.end(), [&](const Measurement& each) { return each.name == result.name; });
    if (measurement == list.end() || !is_quotient(measurement->expression)) continue;
    const Cause cause = cause_of(list[static_cast<std::size_t>(measurement->expression.steps[0].index)], compiled);
    warnings.push_back({Severity::warning, "W-efficiency", result.span,
                        fmt::format("{} = {:.6g} is not an efficiency: {}; try {}", result.name, result.value, cause.text, cause.cure)});
  }
  return warnings;
}

}  // namespace pwlsim::analysis
