#include "circuit/row_step.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace pwlsim::circuit {

namespace {

constexpr double rows_a_period = 2.0;  ///< as many or fewer do not show it
constexpr double suggested_rows = 40.0;

/// Infinite where it does not repeat.
double period_of(const model::SourceFunction& function) {
  if (const auto* sine = std::get_if<model::Sin>(&function); sine && sine->amplitude != 0.0 && sine->frequency > 0.0 && sine->cycles > 1.0)
    return 1.0 / sine->frequency;
  if (const auto* pulse = std::get_if<model::Pulse>(&function); pulse && pulse->initial != pulse->pulsed && pulse->cycles > 1.0)
    return pulse->period;
  return model::forever;
}

}  // namespace

void check_row_step(const model::Network& network, const Transient& transient, Reporter& reporter) {
  const auto fastest = std::min_element(network.sources.begin(), network.sources.end(),
                                        [](const auto& x, const auto& y) { return period_of(x.function) < period_of(y.function); });
  if (fastest == network.sources.end()) return;
  const double period = period_of(fastest->function);
  const double length = transient.stop.seconds - transient.start.seconds, step = transient.row_step();
  if (!(period < length) || step * rows_a_period < period) return;
  reporter.warning(
      "W-coarse-rows", transient.span,
      fmt::format("rows every {:.6g} s do not show {}, whose period is {:.6g} s; for the waveforms try .tran {:.2g} {:.6g} or --plot; "
                  "measurements do not depend on the rows",
                  step, fastest->label.name, period, period / suggested_rows, transient.stop.seconds));
}

}  // namespace pwlsim::circuit
