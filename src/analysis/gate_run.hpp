#pragma once
/// A run that gates without delay cannot finish, and gates that take time can.

#include <functional>
#include <optional>

#include "analysis/prepared_engine.hpp"

namespace pwlsim::analysis {

/// Compiles the deck again, with `.options gatecap`; empty where that has mistakes.
using CompileWithGates = std::function<std::optional<circuit::Compiled>()>;

/// Runs `first`, the engine of `compiled`. Where it ends with switches that keep toggling (`E-no-settle`) and the models of the deck's MOSFETs give their gates resistances or capacitances, which it
/// leaves out, the whole run is repeated with them, and a note says so (`N-gates-take-time`). `compiled` must outlive it; `interrupt` may be null.
[[nodiscard]] Simulate with_gates_at_need(Simulate first, const circuit::Compiled& compiled, CompileWithGates compile, EngineChoice choice,
                                          double reltol, const std::atomic<int>* interrupt);

}  // namespace pwlsim::analysis
