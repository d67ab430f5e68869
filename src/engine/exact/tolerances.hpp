#pragma once

#include "model/tolerances.hpp"

/// Tolerances of this room. Each says what it is relative to (Of) and why it has that size (Why);
/// docs/developer/tolerances.md is made from these lines by docs/developer/make_tolerances.
namespace pwlsim::engine::tolerance {

using model::tolerance::unit_rounding;

// Times

/// Of: the length of the run.
/// Why: 45 units of rounding of its times: breakpoints and crossings that are closer are one instant.
inline constexpr double merge = 1e-14;
/// Of: the step of the rows' grid.
/// Why: a smaller difference is rounding of the times, and the cached matrix is used.
inline constexpr double row_step = 1e-9;
/// Of: a row's time.
/// Why: four units of its last place.
inline constexpr double row_time = 8.9e-16;
/// Of: `merge`, for the length of a decay that is not followed.
/// Why: decays that end within 1e-9 of the run are not visible in its rows.
inline constexpr double unseen_per_merge = 1e5;
/// Of: the length of the run.
/// Why: 400 events within it are an accumulation that cannot be crossed.
inline constexpr double crowd = 1e-9;
/// Of: the length of the run, for crossings of guards without effect.
/// Why: as `crowd`; crossings without effect are cheap, and more of them are needed as a proof.
inline constexpr double idle_crowd = 1e-6;
/// Of: the time from the first event of a sequence to its limit.
/// Why: a limit that is known to rounding is crossed this long before it.
inline constexpr double crossing = 1e-4;
/// Of: the same, if the limit is known to a fraction of the time before it.
/// Why: nearer to it, rounding affects states that shrink with the square of the time.
inline constexpr double last_crossing = 1e-5;
/// Of: the time that a group of events takes, for the rounding of their times.
/// Why: the next groups, whose guards shrink with the square of their time, would have a digit less each.
inline constexpr double lost_event = 1e-3;
/// Of: the time of the limit.
/// Why: 450 units of rounding: the limit is known.
inline constexpr double limit = 1e-13;
/// Of: the time to the limit.
/// Why: two digits of it are enough if rounding allows no more.
inline constexpr double known_limit = 1e-2;
/// Of: the ratio of intervals between events.
/// Why: intervals whose ratios agree to one percent shrink geometrically.
inline constexpr double ratio_spread = 1e-2;
/// Of: the state, for its change from one event of a sequence to the next.
/// Why: five units of rounding: the state has converged.
inline constexpr double converged_state = 1e-15;

// Roots of guards

/// Of: the terms of a guard, as a sum of the slow motion and of decays.
/// Why: the square root of rounding and some digits: a larger difference means that the decays are not those of the state.
inline constexpr double decay_mismatch = 1e-6;
/// Of: the decays' terms at first, when they are over.
/// Why: some 10^5 units of rounding: what is left then is the slow motion, whose sign must be known.
inline constexpr double decay_rounding = 1e-11;
/// Of: the terms that a guard is made of.
/// Why: 450 units of rounding: a minimum this close to zero touches it.
inline constexpr double graze = 1e-13;
/// Of: the sum of the terms' magnitudes of a guard.
/// Why: four units of rounding: a root is found.
inline constexpr double root = 4.0 * unit_rounding;
/// Of: one, as ‖A‖ times the remaining step of a search for a root.
/// Why: Newton's method on the state squares it: the remainder is rounding.
inline constexpr double left_to_polish = 1e-7;
/// Of: one, as ‖A‖ times a step.
/// Why: a second-order step of this length is exact to rounding.
inline constexpr double longest_polish = 1e-6;
/// Of: one, as ‖A‖ times a step.
/// Why: after a shorter step no further one is needed: its square is below rounding.
inline constexpr double last_polish = 1e-8;
/// Of: the interval, for a step to the minimum of a guard.
/// Why: the minimum is flat: its value is known to the square of this.
inline constexpr double minimum_step = 1e-12;
/// Of: the norm of a guard's slope, at its minimum.
/// Why: five units of rounding: the slope is zero.
inline constexpr double minimum_slope = 1e-15;
/// Of: the segment.
/// Why: a shorter interval contains no distinct times, and counts as undecidable.
inline constexpr double smallest_interval = 0x1p-50;
/// Of: the terms of the sum z' of a modal coordinate.
/// Why: eight units of rounding.
inline constexpr double coordinate = 8.0 * unit_rounding;
/// Of: the root, as the last step of Newton's method on a sum of exponentials.
/// Why: the state at the root is refined afterwards.
inline constexpr double modal_root_step = 1e-13;
/// Of: the root, as the last step of Newton's method on a Taylor series.
/// Why: the method squares it: the next step would be below rounding.
inline constexpr double series_root_step = 1e-9;

// States and controls

/// Of: the largest entry of a control's row.
/// Why: a smaller one is the rounding error of a sum of up to a thousand terms.
inline constexpr double row_entry = 1e-12;
/// Of: the largest value of any guard in the run.
/// Why: the remainder in a run that has settled: rounding of rounding.
inline constexpr double remainder = 1e-18;
/// Of: a control's terms at DC, and the largest current or voltage of a port that it reads.
/// Why: 450 units of rounding: the control is at its threshold.
inline constexpr double control_at_start = 1e-13;
/// Of: the norm of the initial values.
/// Why: values that changed by more contradict the circuit, and the run reports this.
inline constexpr double moved_start = 1e-9;

// Certificate, jumps, measurements

/// Of: the sum of the magnitudes of the terms of a row.
/// Why: 64 units of rounding: a smaller residual counts as zero.
inline constexpr double sum_rounding = 64.0 * unit_rounding;
/// Of: the largest term of an island, for a row whose terms never exceed it.
/// Why: the terms of such a row may be rounding errors of the largest term.
inline constexpr double idle_row = 1e-3;
/// Of: one, as the certificate's worst residual.
/// Why: six digits are what pictures and measurements show; beyond it the run warns.
inline constexpr double doubtful_residual = 1e-6;
/// Of: the largest impulse of an instant.
/// Why: some thousand roundings of double: a smaller one is rounding.
inline constexpr double impulse = 1e-12;
/// Of: the terms that an impulse of a signal is a sum of.
/// Why: as `impulse`.
inline constexpr double probe_impulse = 1e-12;
/// Of: the end of a run.
/// Why: an event just before the end, because of rounding, leaves a segment this short, in which every control seems constant.
inline constexpr double brief_rest = 1e-12;
/// Of: the value of a capacitor or inductor, for its change at an instant.
/// Why: 45 units of rounding: a smaller change is not a jump.
inline constexpr double change = 1e-14;
/// Of: the energy stored before a jump.
/// Why: a smaller loss is rounding, or that of a nearly perfect coupling.
inline constexpr double least_loss = 1e-9;
/// Of: the current of an inductor.
/// Why: if a larger share is lost, the current counts as broken.
inline constexpr double least_broken_current = 1e-6;
/// Of: the largest value of a signal on an interval, for its last coefficients.
/// Why: nine units of rounding: the polynomial has all digits.
inline constexpr double piece_resolution = 2e-15;
/// Of: one, for sums of a polynomial's coefficients.
/// Why: one unit of rounding of double, rounded up.
inline constexpr double piece_rounding = 2.3e-16;
/// Of: the largest value of a signal in the run.
/// Why: a smaller value needs no digits of its own.
inline constexpr double piece_dead = 1e-12;
/// Of: |c e^{Aτ}||y|.
/// Why: eight roundings: a value at a point.
inline constexpr double piece_point = 8.0 * piece_rounding;
/// Of: the terms of a derivative at the start of an interval.
/// Why: sixteen roundings.
inline constexpr double piece_derivative = 16.0 * piece_rounding;
/// Of: the window of the measurements.
/// Why: intervals become this short only if rounding is larger than `piece_resolution`.
inline constexpr double piece_crowding = 1e-7;

// DC operating point, in extended precision

/// Of: ξ and u, of their largest.
/// Why: two solutions that differ by less are equal: 10^5 units of rounding.
inline constexpr long double same_value = 1e-14L;
/// Of: an equation's coefficients times the largest ξ and u.
/// Why: a residual of a linear solution in extended precision is below it.
inline constexpr long double dc_residual = 1e-12L;
/// Of: an entry of D, which is of order one.
/// Why: D was rounded to double.
inline constexpr long double dc_port_rounding = 1e-15L;
/// Of: ξ and u, of the largest of both.
/// Why: the proximal iteration has converged.
inline constexpr long double dc_small_change = 1e-12L;
/// Of: v in a step.
/// Why: without a solution v keeps growing; noise that stays is below it.
inline constexpr long double dc_largest_noise = 1e-6L;
/// Of: a random vector.
/// Why: if more of it remains when all but the kernel has decayed, the kernel is not empty.
inline constexpr long double dc_free_share = 1e-6L;
/// Of: the largest term of any u or y.
/// Why: some 10^7 units of rounding of extended precision: the sign is known.
inline constexpr long double dc_sign = 1e-12L;
/// Of: the larger of two distances from zero.
/// Why: the distance at ε > 0 is a lower bound up to ε.
inline constexpr double dc_same_distance = 1e-6;
/// Of: the norm of a state.
/// Why: two starts that end closer have found the same operating point.
inline constexpr double dc_same_state = 1e-6;
/// Of: the largest ξ.
/// Why: an operating point that rounding leaves less than ten digits is sought by another way, too.
inline constexpr double dc_doubt = 1e-10;
/// Of: the rounding of an operating point, and: the largest ξ.
/// Why: a bound of many sums is rarely as much too small; and what differs by more is another point.
inline constexpr double dc_doubts = 1e2, dc_largest_doubt = 1e-3;
/// Of: a wave, at its port.
/// Why: parallel diodes and rings of closed switches share their current, series ones their voltage; nothing else changes by more.
inline constexpr long double dc_wave_loss = 1e-12L;

}  // namespace pwlsim::engine::tolerance
