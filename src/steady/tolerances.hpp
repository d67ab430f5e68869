#pragma once

#include "model/tolerances.hpp"

/// Tolerances of this room. Each says what it is relative to (Of) and why it has that size (Why);
/// docs/developer/tolerances.md is made from these lines by docs/developer/make_tolerances.
namespace pwlsim::steady::tolerance {

// Times

/// Of: the length of the trace, and the time.
/// Why: some thousand roundings of times that are sums of segments: instants and edges this close are one.
inline constexpr double same_instant = 1e-12;
/// Of: the period.
/// Why: a segment that ends this close to its end is the last.
inline constexpr double near_end = 1e-9;
/// Of: the period.
/// Why: what holds on one side of an instant is in force this far beside it.
inline constexpr double just_beside = 1e-9;
/// Of: the length of an interval.
/// Why: as `same_instant`: products of intervals that differ by less are added up.
inline constexpr double same_length = 1e-12;
/// Of: a ratio of two decimal numbers.
/// Why: nine units of rounding: the ratio is that of two integers.
inline constexpr double ratio_rounding = 2e-15;
/// Of: a ratio of two periods, one of which is given.
/// Why: a hint is written with some digits less: the ratio is a whole number.
inline constexpr double whole_ratio = 1e-12;

// Orbits

/// Of: the largest singular value of I − Φ, or one.
/// Why: four digits beside Φ's rounding: a smaller one is zero, and its direction is free.
inline constexpr double free_direction = 1e-11;
/// Of: the largest state.
/// Why: from here on a residual that no step lessens is rounding of long or stiff periods.
inline constexpr double close_residual = 1e-10;
/// Of: the largest state, for what the residual has outside of the range of I − Φ.
/// Why: a hundred times `free_direction`: more of it means that there is no orbit along a free direction.
inline constexpr double inconsistent_residual = 1e-9;
/// Of: one.
/// Why: 450 units of rounding: a smaller multiplier is that of a state that a jump or a constraint takes away.
inline constexpr double zero_multiplier = 1e-13;
/// Of: the largest motion within a period.
/// Why: with more of a residual along a free direction there may be no orbit.
inline constexpr double residual_of_swing = 1e-10;
/// Of: the residual.
/// Why: what else moves beside a drift has settled.
inline constexpr double lone_drift = 1e-6;
/// Of: a direction.
/// Why: a direction that changes by less in a period counts as constant: integrators with slow leaks.
inline constexpr double constant_direction = 1e-6;
/// Of: the fastest rate of a mode.
/// Why: slower motions are integrators' to rounding, and say nothing of how long an orbit takes.
inline constexpr double resting_rate = 1e-9;
/// Of: the norm of a residual.
/// Why: far below what a step changes, and above what is left of the way into a cycle after a few rounds.
inline constexpr double same_residual = 1e-6;
/// Of: the largest state.
/// Why: two orbits that differ by less are one; both are known to `close_residual`.
inline constexpr double same_orbit = 1e-8;
/// Of: the largest state.
/// Why: far beyond the orbit's own error, and still near it.
inline constexpr double push = 1e-2;

// Orbits by Krylov segments

/// Of: the right-hand side of a linear system with the derivative of a lap.
/// Why: Newton's method corrects what is left.
inline constexpr double solved_system = 1e-5;
/// Of: the same, of implicit steps, tests of steps and estimates.
/// Why: they need the size of a solution only.
inline constexpr double solved_roughly = 1e-2;
/// Of: the largest state, times the root of the number of segments.
/// Why: five units of rounding a segment: a residual so small is none.
inline constexpr double lap_rounding = 1e-15;
/// Of: the largest state.
/// Why: as `close_residual`: segments have a digit less. From here on a residual that no step lessens is rounding.
inline constexpr double close_lap = 1e-9;
/// Of: one, as a distance from an eigenvalue of the derivative.
/// Why: segments know an eigenvalue to about nine digits: it is 1.
inline constexpr double multiplier_at_one = 1e-9;
/// Of: the largest state, for what the residual has along an eigenvector at 1.
/// Why: as `close_lap`: more than that no step takes away.
inline constexpr double unreachable_residual = 1e-9;
/// Of: a product with the derivative.
/// Why: 450 units of rounding: what is left of it outside of the space is rounding.
inline constexpr double invariant_space = 1e-13;
/// Of: the largest singular value of a projected equation.
/// Why: below the digits of segments: a smaller one is zero.
inline constexpr double zero_singular_value = 1e-10;
/// Of: a multiplier, or one, for its residual.
/// Why: what segments know of it.
inline constexpr double known_multiplier = 1e-9;
/// Of: one.
/// Why: as `known_multiplier`: a smaller multiplier is not known to any digit.
inline constexpr double zero_leading_multiplier = 1e-9;
/// Of: the largest state.
/// Why: the deviation of runs that check the derivative: half of the digits.
inline constexpr double beside_orbit = 1e-6;
/// Of: that deviation.
/// Why: three digits are left of it beside rounding and curvature.
inline constexpr double follows_derivative = 1e-3;
/// Of: the largest state.
/// Why: as `same_orbit`: two points of an orbit that differ by less are one.
inline constexpr double repeated_point = 1e-8;

// Passages and their order

/// Of: a guard's row times the speed of the state.
/// Why: a guard that falls slower touches zero: there is no derivative.
inline constexpr double touching = 1e-9;
/// Of: a guard's row times a direction.
/// Why: what the direction does to the guard is rounding.
inline constexpr double unmoved_guard = 1e-9;
/// Of: the speeds of a state before and after a change.
/// Why: speeds that differ by less are one: when the change comes does not matter.
inline constexpr double same_speed = 1e-9;
/// Of: two rows that say when guards are passed, for a deviation.
/// Why: they are quotients by speeds down to `touching`: guards whose rows agree to seven digits are passed together.
inline constexpr double same_shift_row = 1e-7;
/// Of: the length of the trace, for a shift by all of the state.
/// Why: as `same_instant`: a smaller shift is rounding.
inline constexpr double no_shift_row = 1e-12;
/// Of: two shifts of one instant.
/// Why: shifts that differ by less are one.
inline constexpr double same_shift = 1e-9;
/// Of: the length of the run, for a change by all of the parameter.
/// Why: ten times `no_shift_row`: shifts along a whole run have more rounding.
inline constexpr double no_shift = 1e-11;
/// Of: the entries of two rows that say when a guard is passed.
/// Why: as `same_shift`: the two guards are one, but for their thresholds.
inline constexpr double same_guard = 1e-9;
/// Of: the terms of a control, and its level.
/// Why: what sources alone drive passes its threshold at a time that is known to it.
inline constexpr double on_level = 1e-9;
/// Of: the largest value of a guard in a segment.
/// Why: a least value inside the segment that is smaller touches zero.
inline constexpr double touch = 1e-9;
/// Of: the terms of a guard.
/// Why: some thousand roundings: the guard is zero.
inline constexpr double resting_guard = 1e-12;
/// Of: the terms of a guard's derivative.
/// Why: it stays at zero where a parameter moves.
inline constexpr double resting_slope = 1e-9;
/// Of: the impulses of a jump.
/// Why: those of its parts add up to them: they are linear in the state before.
inline constexpr double proportional_impulse = 1e-9;
/// Of: the terms of a signal.
/// Why: 64 units of rounding: it does not jump by less.
inline constexpr double signal_rounding = 64.0 * model::tolerance::unit_rounding;
/// Of: a state, and a column of a projector.
/// Why: 45 units of rounding: the jump leaves it as it is.
inline constexpr double no_jump = 1e-14;

// Linear equations

/// Of: the entries of two matrices.
/// Why: five digits beside their rounding: two models hold the same stores, and have the same modes.
inline constexpr double same_coordinates = 1e-11;
/// Of: the largest pivot, rows and columns scaled to one.
/// Why: 10^6 roundings of the extended format: an equation with less is none.
inline constexpr double dc_pivot = 1e-13;
/// Of: a vector of the kernel (for its states), and the right-hand side (for the residual).
/// Why: half of the digits of the extended format: the states are open, or the equations contradict each other.
inline constexpr long double dc_share = 1e-9L;
/// Of: one, as the reciprocal condition of scaled inductances.
/// Why: below it inductors are perfectly coupled.
inline constexpr double coupled_pivot = 1e-12;
/// Of: one, as the length of a stretch times 1/‖(A − jω)⁻¹‖.
/// Why: what is solved for cancels to its square: below it a series is summed (integrators, lossless resonances).
inline constexpr double brief_stretch = 1e-3;
/// Of: the norm of I − e^{−jωT}Φ, or one.
/// Why: four digits are left: the response is infinite.
inline constexpr double singular_response = 1e-12;
/// Of: the largest singular value of I − e^{−jωT}Φ, or one.
/// Why: above what rounding of Φ leaves of a zero, and below what another multiplier leaves.
inline constexpr double resonant_direction = 1e-11;
/// Of: what the input adds to the states in a period, at this frequency or a quarter of a turn beside it.
/// Why: rounding of a sum over the period.
inline constexpr double unexcited_direction = 1e-11;

}  // namespace pwlsim::steady::tolerance
