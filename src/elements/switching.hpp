#pragma once
/// What S and W share: thresholds from their models, and the switch with its off resistance, drop and inductance.

#include "elements/emission.hpp"

namespace pwlsim::elements {

inline constexpr Parameter switch_on_resistance{"Ron", "ohm", 0.0, Range::not_negative, false, "Resistance when on."};
inline constexpr Parameter switch_off_resistance{"Roff", "ohm", infinite, Range::not_negative, true, "Resistance when off."};
inline constexpr Parameter switch_inductance{"Lser", "H", 0.0, Range::any, false, "Inductance in series."};
inline constexpr Parameter switch_drop{"Vser", "V", 0.0, Range::any, false, "Voltage source in series."};
inline constexpr Parameter switch_limit{"Ilimit", "A", infinite, Range::positive, true, "Limit of the current.", Use::ignored};
inline constexpr Parameter switch_level{"level", "", 1.0, Range::any, false, "Variant with a smooth transition.", Use::ignored};
inline constexpr Parameter switch_one_way{"oneway", "", 0.0, Range::any, false, "Conduction in one direction.", Use::refused};
inline constexpr Parameter switch_corner{"epsilon", "V", 0.0, Range::any, false, "Width of a rounded corner.", Use::refused};

/// `complete` for models with a threshold and a hysteresis: a negative hysteresis becomes zero, with a note.
void complete_hysteresis(Model& model, std::string_view threshold, std::string_view hysteresis, Diagnostics& diagnostics);

/// Closed while scale·control is above `on`; opens below `off`, off ≤ on.
struct Thresholds {
  double on = 0.0, off = 0.0, scale = 1.0;
};
/// From a model with Vt/Vh, It/Ih, or an on and an off level (off above on: inverted).
[[nodiscard]] Thresholds thresholds(const Model& model);

/// Adds the switch and the parts that its model adds. set_control sets its control in the second pass.
void add_switch(Emission& emission);
void set_control(Emission& emission, const model::LinearForm& control);

}  // namespace pwlsim::elements
