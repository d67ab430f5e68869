#pragma once
/// XSPICE's oscillators as sources and expressions (ngspice's manual, "Controlled Triangle Wave Oscillator" and its like, "PWM Oscillator"). A phase from 0 to 1 runs
/// with the frequency that the control gives; with a constant frequency it is a source.
///
///     triangle   from out_low at phase 0 to out_high at duty_cycle, and back
///     square     out_high from phase 1 - duty_cycle on, out_low before
///     sine       (out_high + out_low)/2 + (out_high - out_low)/2 sin(2π phase)
///     d_osc      a bit: 1 from phase 1 - duty_cycle on
///     d_pwm      the same, with the duty cycle that the control gives

#include <functional>
#include <span>
#include <string_view>

#include "netlist/ast.hpp"

namespace pwlsim::circuit {

[[nodiscard]] bool is_oscillator(std::string_view type);

/// The value that a model gives for a parameter, or null.
using GivenParameter = std::function<const netlist::Item*(std::string_view name)>;

/// The source that replaces the A card: a V, or a B that reads the control; `control` and `output` have one or two nodes each.
[[nodiscard]] netlist::Card oscillator_card(const netlist::Card& card, std::string_view type, std::span<const netlist::Item> control,
                                            std::span<const netlist::Item> output, const GivenParameter& given);

}  // namespace pwlsim::circuit
