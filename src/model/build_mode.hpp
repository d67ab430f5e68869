#pragma once

#include <memory>

#include "model/mode.hpp"
#include "model/slow_manifold.hpp"

namespace pwlsim::model {

/// Builds the mode of `active`, with blocking valves on that side; `regular` is false if V ⊕ T is not the whole space.
[[nodiscard]] std::unique_ptr<Mode> build_mode(const System& system, const IndexSet& active);

/// The slow motion of a mode that leaves decays which are much faster, with time constants of at most `longest`, s: V is then the slow manifold, T the fast subspace
/// (slow_manifold.hpp). `rates`: those of `whole`. Null if it has none.
[[nodiscard]] std::unique_ptr<Mode> build_slow_mode(const System& system, const Mode& whole, const Rates& rates, ShiftedSystems& shifted,
                                                    double longest);

}  // namespace pwlsim::model
