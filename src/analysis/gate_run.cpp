#include "analysis/gate_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "analysis/fitted_diodes.hpp"
#include "analysis/quantity.hpp"
#include "analysis/trial_run.hpp"

namespace pwlsim::analysis {
namespace {

/// Whether gates were left out of `first`, and the rows of `other` have the same columns.
bool has_gates_of(const circuit::Compiled& other, const circuit::Compiled& first) {
  const model::Network &more = other.network, &less = first.network;
  const bool has_more = more.capacitors.size() > less.capacitors.size() || more.resistors.size() > less.resistors.size();
  const auto same = [](const model::Signal& a, const model::Signal& b) { return a.name == b.name; };
  return has_more && other.saved_signals() == first.saved_signals() &&
         std::equal(more.signals.begin(), more.signals.end(), less.signals.begin(), less.signals.end(), same);
}

engine::Remark remark(const engine::Answer& failed) {
  return {"N-gates-take-time",
          fmt::format("gates without delay keep toggling at t = {}; the whole run was repeated with the gate resistances and capacitances "
                      "of the models, as with .options gatecap",
                      quantity(failed.time, "s"))};
}

}  // namespace

Simulate with_gates_at_need(Simulate first, const circuit::Compiled& compiled, CompileWithGates compile, EngineChoice choice, double reltol,
                            const std::atomic<int>* interrupt) {
  const auto other = [=, first_deck = &compiled, compile = std::move(compile)](const engine::Answer& failed) -> Simulate {
    if (failed.id != "E-no-settle") return {};
    std::optional<circuit::Compiled> again = compile();
    if (!again || !has_gates_of(*again, *first_deck)) return {};
    (void)fit_diodes(*again, choice, reltol, interrupt);
    Diagnostics ignored;
    PreparedEngine engine = interrupt != nullptr ? prepare_engine(again->network, choice, reltol, ignored, *interrupt)
                                                 : prepare_engine(again->network, choice, reltol, ignored);
    return std::move(engine.simulate);
  };
  return tried_first(std::move(first), other, remark);
}

}  // namespace pwlsim::analysis
