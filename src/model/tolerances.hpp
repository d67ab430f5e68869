#pragma once

#include "linalg/dense.hpp"

/// Tolerances of this room. Each says what it is relative to (Of) and why it has that size (Why);
/// docs/developer/tolerances.md is made from these lines by docs/developer/make_tolerances.
namespace pwlsim::model::tolerance {

// Rounding

/// Of: one; the distance of one to the next number of double.
/// Why: 2^-52.
inline constexpr double unit_rounding = 2.220446049250313e-16;
/// Of: one; the same for the extended format of x86-64.
/// Why: 2^-63.
inline constexpr double wide_unit_rounding = 1.084202172485504e-19;
/// Of: a number of the netlist.
/// Why: its decimal text was rounded to double: numbers that differ by less cancel.
inline constexpr long double data_rounding = 1e-15L;
/// Of: `data_rounding`'s terms, for residuals in twice the digits.
/// Why: 1e-30 of the terms, over the level at which linalg sets entries to zero.
inline constexpr long double residual_rounding = 1e-30L / linalg::wide_clean_tolerance;
/// Of: a row of terms, one unit of rounding each, both in double.
/// Why: five units of rounding: the last place of a sum of some terms.
inline constexpr long double output_rounding = 1e-15L;
/// Of: the terms of a row on a slow manifold, in extended precision.
/// Why: ten units of its rounding; products with large resistances cancel there.
inline constexpr long double manifold_rounding = 1e-18L;
/// Of: an entry of A, in extended precision.
/// Why: 16 units of its rounding: an entry is a sum of some terms.
inline constexpr double rate_rounding = 16.0 * wide_unit_rounding;
/// Of: the slow motion of a mode, for what rounding of its fast rates makes of it while the mode is followed.
/// Why: a tenth of what rows may be off.
inline constexpr double lost_in_flow = 1e-10;
/// Of: the entries of orthonormal vectors, in extended precision.
/// Why: twenty units of rounding: a sum of some products.
inline constexpr double basis_rounding = 1e-18;
/// Of: entries of unit vectors, in double.
/// Why: some thousand roundings: entries below it are zero when a report prints coordinates.
inline constexpr double unit_vector_entry = 1e-12;
/// Of: the largest entry of a row (of a control or of an output).
/// Why: both sides were rounded to double after different sums of up to a thousand terms.
inline constexpr double row_entry = 1e-12;
/// Of: the terms of a guard row on a slow manifold, relative to the row of C in the same sum.
/// Why: five units of rounding of double.
inline constexpr double guard_row_rounding = 1e-15;
/// Of: the largest diode row of a mode.
/// Why: five units of rounding: a smaller row is an error of cancellation, and two rows that differ by less are equal.
inline constexpr double diode_row_rounding = 1e-15;
/// Of: the state of a run, relative to the largest so far.
/// Why: 30 units of rounding: the rounding error of a jump or an exponential.
inline constexpr double state_rounding = 30.0 * unit_rounding;
/// Of: the largest guard so far, at relaxed levels only.
/// Why: rounding of a rounding error: the remainder of a decay to zero.
inline constexpr double remainder_of_decay = 1e-18;
/// Of: the state, for derivatives that are zero; of u and y, times the largest row that gives them.
/// Why: five units of rounding of double.
inline constexpr double derivative_rounding = 1e-15;
/// Of: its own size, as an age of a burst times its frequency.
/// Why: a thousand units of rounding of sine and exponential.
inline constexpr double burst_end = 1e3 * unit_rounding;

// Ranks and pivots

/// Of: singular values of equilibrated rows (Markov parameters, D + Dᵀ, impulses, stores).
/// Why: far above rounding, and below the ratios of elements of one kind that must count as different from zero.
inline constexpr double rank = 1e-9;
/// Of: unit vectors and equilibrated rows, in extended precision.
/// Why: subspaces of a mode are compared with each other: the rounding of extended precision times the allowed condition number.
inline constexpr double subspace_rank = 1e-10;
/// Of: rows and columns after scaling to a largest entry of one.
/// Why: a smaller row is an error of cancellation, and does not count in a rank.
inline constexpr double noise_row = 1e-12;
/// Of: one, as the condition number of [V T].
/// Why: beyond it fewer than seven digits of extended precision are left for a jump.
inline constexpr double largest_condition = 1e12;
/// Of: a pivot, rows and columns scaled to a largest entry of one.
/// Why: some thousand roundings of double: a smaller principal minor is zero.
inline constexpr double minor = 1e-12;
/// Of: singular values of unit directions of the contacts.
/// Why: below `rank`: switches of 1 mΩ beside leaks of 1 GΩ still count.
inline constexpr double switch_rank = 1e-11;
/// Of: singular values of the normalised matrix of first Markov parameters on the kernel of D_JJ.
/// Why: as `rank`.
inline constexpr double jump_rank = 1e-9;
/// Of: singular values of the terms that free inputs move.
/// Why: as `subspace_rank`.
inline constexpr double free_input_rank = 1e-10;
/// Of: one, as an entry of a unit direction of free inputs.
/// Why: a larger entry means that the port belongs to the open direction.
inline constexpr long double free_input_entry = 1e-9L;
/// Of: the largest pivot of G in double.
/// Why: a network whose pivots are above it is regular without further examination.
inline constexpr double regular_network = 1e-9;
/// Of: the largest pivot of D_JJ in extended precision.
/// Why: a block whose pivots are above it is regular without further examination.
inline constexpr long double regular_block = 1e-10L;
/// Of: one, as an entry of a null vector of order one.
/// Why: a larger entry belongs to the null vector; rounding errors are below 1e-9.
inline constexpr double null_vector_entry = 1e-6;
/// Of: the largest entry of a row-equilibrated G, for a whole column.
/// Why: a quantity with small coefficients in its equations (an integrator's current) is not undetermined.
inline constexpr double small_column = 1e-3;
/// Of: the same.
/// Why: five units of rounding of double: the column is zero.
inline constexpr double rounding_column = 1e-15;
/// Of: the parts of an entry of a hidden constraint.
/// Why: some thousand roundings of double: a smaller entry is an error of cancellation.
inline constexpr double constraint_entry = 1e-12;
/// Of: the larger of two pivots of ports.
/// Why: pivots that differ by less count as equal, and the order of the deck decides.
inline constexpr double same_pivot = 1e-9;
/// Of: one, as a pivot of the inductance matrix with unit diagonal.
/// Why: |k| = 1 to the digits that a coupling is written with.
inline constexpr double coupling_rank = 1e-12;
/// Of: R0 of the part.
/// Why: the conductance of a smaller resistance would dominate its node's row; its current is an unknown instead.
inline constexpr double low_resistance = 1e-3;
/// Of: the larger of two potentials, each as the sum of the magnitudes of its sources.
/// Why: sums of a few sources differ by their rounding only.
inline constexpr double same_potential = 1e-12;
/// Of: one, as a pivot of the ports' equations on a slow manifold, in extended precision.
/// Why: a hundred units of its rounding.
inline constexpr long double manifold_pivot = 1e-17L;
/// Of: terms of order one, in extended precision.
/// Why: the residual of an equation that is an identity is smaller.
inline constexpr long double manifold_identity = 1e-13L;
/// Of: the norm of an eigenvector's terms.
/// Why: a larger residual means that the vector is not one, and the mode is not split.
inline constexpr double eigenvector = 1e-9;
/// Of: the time constant of the slowest of several decays, for the rounding of the fastest one's rate in it.
/// Why: e^{−τ/T} is then known to 10⁻⁹ to its end, far below what decides about a guard.
inline constexpr double sharp_decay = 1e-9;
/// Of: the rate of a row of V⁻¹(M V − V Λ).
/// Why: rates are followed over up to 10^4 of their periods: six digits of a root are left.
inline constexpr long double rate_error = 1e-10L;
/// Of: a state, within the time for which eigenvectors serve.
/// Why: as `rate_error` over 10^4 periods: what they do not know of a motion counts as its rounding.
inline constexpr long double motion_error = 1e-6L;
/// Of: ‖M‖.
/// Why: a slower rate is the rounding error of zero, and is not taken as the smallest rate.
inline constexpr long double slowest_rate = 1e-14L;
/// Of: its terms, for an entry of M in the search for further solutions.
/// Why: a smaller entry counts as zero, and is not pivoted on.
inline constexpr double neighbour_pivot = 1e-9;
/// Of: rows and columns of G(s).
/// Why: ports whose rows and columns differ by less count once.
inline constexpr double twin = 1e-10;

// Noise of guards and conditions of modes

/// Of: the terms of a guard.
/// Why: the least rounding level of a guard: 135 units of rounding, sums of some tens of terms.
inline constexpr double noise_floor = 3e-14;
/// Of: the terms of a guard, for each unit of the condition number.
/// Why: 30 units of rounding of double.
inline constexpr double noise_per_condition = 30.0 * unit_rounding;
/// Of: the same if D was not rounded to double.
/// Why: 30 units of rounding of extended precision.
inline constexpr double wide_noise_per_condition = 30.0 * wide_unit_rounding;
/// Of: the bound of a solution of D_JJ u = −C_J x, D rounded to double.
/// Why: 45 units of rounding of double.
inline constexpr long double solution_noise = 1e-14L;
/// Of: the same if D was not rounded to double.
/// Why: 37 units of rounding of extended precision.
inline constexpr long double wide_solution_noise = 4e-18L;
/// Of: an entry of D, if it was not rounded to double.
/// Why: the numbers of a netlist are known to that.
inline constexpr long double entry_doubt = 1e-15L;
/// Of: an entry of D, of order one, if it was rounded to double.
/// Why: some 10^5 units of rounding: elements of very different size cancel in it.
inline constexpr long double rounded_doubt = 1e-10L;
/// Of: the terms of a constraint or a jump direction, in extended precision.
/// Why: 10^5 units of its rounding: below it the terms cancel, and the port is not determined.
inline constexpr long double cancelled_norm = 1e-14L;
/// Of: the terms of a guard.
/// Why: a guard with more noise counts as if it had this: a potential held by leaks of 10^13 Ω does not justify a missed event.
inline constexpr double largest_guard_noise = 1e-9;
/// Of: the terms of a row, from the entries of D_JJ and C_J.
/// Why: that bound is decades above the actual rounding: a larger value would let a guard stay below zero.
inline constexpr double largest_row_noise = 1e-12;
/// Of: the terms of a guard, in the verification of a mode.
/// Why: the sign of a guard with more noise is decided as if it had this.
inline constexpr double most_guard_noise = 1e-11;
/// Of: the terms of a power series of the rational problem.
/// Why: as `noise_floor`.
inline constexpr double series_noise = 3e-14;
/// Of: the largest of two quantities of a port at large s.
/// Why: a tie to rounding: both sides are tried.
inline constexpr double port_tie = 1e-12;
/// Of: a problem whose diagonal is about one.
/// Why: the square root of rounding, as in lcp.
inline constexpr double regularisation = 1e-8;
/// Of: ‖A‖.
/// Why: a smaller logarithmic norm is rounding of eigenvalues of A + Aᵀ.
inline constexpr double growth = 1e-10;

// Passivity, uniqueness, jumps

/// Of: the terms of a signal along an open direction of u.
/// Why: a signal changes along it if its terms do not cancel.
inline constexpr double open_signal = 1e-9;
/// Of: ‖row‖·‖y‖ of a guard.
/// Why: a mode with a larger violation is not a continuation.
inline constexpr double clearly_violated = 1e-6;
/// Of: the mode's own rounding level.
/// Why: as `clearly_violated`, if rounding is larger.
inline constexpr double clearly_above_noise = 1e3;
/// Of: the larger of two derivatives.
/// Why: continuations of two modes are the same if all derivatives agree to this.
inline constexpr double same_derivative = 1e-9;
/// Of: the derivative before it.
/// Why: a derivative that vanishes is compared with the one before, with three digits less.
inline constexpr double vanishing_derivative = 1e-3;
/// Of: the terms of q, in the search for further solutions.
/// Why: far above its rounding: a mode may be excluded only with certainty.
inline constexpr double neighbour_value = 1e-9;
/// Of: the largest state so far.
/// Why: far above the rounding of a state.
inline constexpr double neighbour_state = 1e-12;
/// Of: a mode's rounding level, for ‖P x − x‖ against ‖x‖.
/// Why: a smaller distance is not a jump.
inline constexpr double consistency_per_noise = 30.0;
/// Of: the largest impulse.
/// Why: products of ranks and of states: a smaller impulse is rounding.
inline constexpr double impulse = 1e-8;

}  // namespace pwlsim::model::tolerance
