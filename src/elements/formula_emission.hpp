#pragma once
/// Emits a formula as linear forms, complementarities and switches of the network, and the sources that it drives.

#include <functional>

#include "elements/emission.hpp"
#include "elements/moving_form.hpp"

namespace pwlsim::elements {

using Signals = std::function<model::LinearForm(const FormulaPart&)>;

/// Second pass only: the currents it reads must exist. Each part is emitted once, and only if the value needs it.
[[nodiscard]] MovingForm emit_formula(Emission& emission, const Formula& formula);
/// With `signals` for the voltages and currents.
[[nodiscard]] MovingForm emit_formula(Emission& emission, const Formula& formula, const Signals& signals);

/// A voltage or current source between the element's terminals, whose value set_source_value gives in the second pass.
void add_formula_source(Emission& emission, bool is_current);
void set_source_value(Emission& emission, const MovingForm& value, bool is_current);

/// Whether the element's two terminals are tied together by a voltage that its formula sets.
[[nodiscard]] bool is_voltage_formula(const Instance& instance);

}  // namespace pwlsim::elements
