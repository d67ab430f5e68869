#pragma once

#include <memory>

#include "model/mode.hpp"
#include "model/slow_manifold.hpp"

namespace pwlsim::model {

/// Builds the mode of `active`, with blocking valves on that side; `regular` is false if V ⊕ T is not the whole space.
[[nodiscard]] std::unique_ptr<Mode> build_mode(const System& system, const IndexSet& active);

/// The slow motion that a mode's decays above the cut leave: V is then the slow manifold, T the fast subspace (slow_manifold.hpp). Null if there are none, or if they are no
/// plain decays.
[[nodiscard]] std::unique_ptr<Mode> build_slow_mode(const System& system, const Mode& whole, const Cut& cut, ShiftedSystems& shifted);

}  // namespace pwlsim::model
