#include "analysis/gate_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "analysis/fitted_diodes.hpp"
#include "analysis/quantity.hpp"
#include "analysis/trial_run.hpp"

namespace pwlsim::analysis {
namespace {

/// What tells whether gates were left out, and whether the rows of the other run have the same columns.
struct Shape {
  std::size_t stores = 0, resistors = 0, saved = 0;
  std::vector<std::string> signals;
};

Shape shape_of(const circuit::Compiled& compiled) {
  const model::Network& network = compiled.network;
  Shape shape{network.capacitors.size(), network.resistors.size(), compiled.saved_signals(), {}};
  for (const model::Signal& signal : network.signals) shape.signals.push_back(signal.name);
  return shape;
}

bool has_gates_of(const Shape& other, const Shape& first) {
  const bool has_more = other.stores > first.stores || other.resistors > first.resistors;
  return has_more && other.saved == first.saved && other.signals == first.signals;
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
  const auto other = [=, shape = shape_of(compiled), compile = std::move(compile)](const engine::Answer& failed) -> Simulate {
    if (failed.id != "E-no-settle") return {};
    std::optional<circuit::Compiled> again = compile();
    if (!again || !has_gates_of(shape_of(*again), shape)) return {};
    (void)fit_diodes(*again, choice, reltol, interrupt);
    Diagnostics ignored;
    PreparedEngine engine = interrupt != nullptr ? prepare_engine(again->network, choice, reltol, ignored, *interrupt)
                                                 : prepare_engine(again->network, choice, reltol, ignored);
    return std::move(engine.simulate);
  };
  return tried_first(std::move(first), other, remark);
}

}  // namespace pwlsim::analysis
