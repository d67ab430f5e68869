#include "cli/sensitivity_session.hpp"

#include <fmt/format.h>

#include <iterator>
#include <utility>

#include "analysis/quantity.hpp"
#include "cli/output.hpp"
#include "cli/signals.hpp"

namespace pwlsim::cli {

int run_sensitivities(const circuit::Compiled& compiled, bool is_exact, const SensitivityOutput& output, analysis::RunOutcome& outcome,
                      Messages& messages) {
  outcome.sensitivities =
      analysis::deck_derivatives(compiled, outcome.steady_state ? &*outcome.steady_state : nullptr, is_exact, caught_signal());
  report_derivatives(outcome.sensitivities, messages);
  int status = 0;
  if (output.is_printed) status = print(analysis::derivative_text(outcome.sensitivities, output.digits), messages, output.stream);
  if (output.file == nullptr || status != 0) return status;
  status = write_whole(*output.file, analysis::derivative_csv(outcome.sensitivities), messages);
  if (status == 0)
    messages.remark(fmt::format("wrote {}: {}\n", output.file->name(), analysis::counted(outcome.sensitivities.size(), "derivative")));
  return status;
}

void report_derivatives(const analysis::DerivativeTable& table, Messages& messages, const std::string& where) {
  for (const analysis::Derivative& d : table) {
    if (!d.failure.empty())
      messages.report({Severity::warning,
                       "W-sens-failed",
                       {},
                       fmt::format("{} has no derivative to {}{}: {}", d.measurement, d.parameter, where, d.failure)});
    else if (!d.kink.empty())
      messages.report({Severity::warning,
                       "W-sens-one-sided",
                       {},
                       fmt::format("the derivative of {} to {} is {:.6g} from the left and {:.6g} from the right{}: {}", d.measurement,
                                   d.parameter, d.left, d.right, where, d.kink)});
  }
}

}  // namespace pwlsim::cli
