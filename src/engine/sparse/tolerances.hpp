#pragma once

/// Tolerances of this room. Each says what it is relative to (Of) and why it has that size (Why);
/// docs/developer/tolerances.md is made from these lines by docs/developer/make_tolerances.
namespace pwlsim::engine::sparse::tolerance {

// Times

/// Of: the length of the run.
/// Why: as `merge` of the exact engine: 45 units of rounding of its times.
inline constexpr double merge = 1e-14;
/// Of: the length of the run, for breakpoints of sources, and gates.
/// Why: their times are sums and products of decimal numbers; no step can be so short.
inline constexpr double same_break = 1e-11;
/// Of: the length of the run.
/// Why: five units of rounding of its times: what is faster is left to the laws of jumps (an inductor behind Roff alone).
inline constexpr double shortest_step = 1e-15;
/// Of: a step.
/// Why: a smaller remainder is rounding of the place of a cut: there is nothing to cut.
inline constexpr double whole_step = 1.0 - 1e-9;
/// Of: a step.
/// Why: guards that pass within it pass at one instant: the parabola through a step is no better.
inline constexpr double same_passage = 1e-6;
/// Of: the time.
/// Why: 450 units of rounding: a shorter step of implicit Euler has no digits.
inline constexpr double shortest_euler_step = 1e-13;
/// Of: the length of the run.
/// Why: as `crowd` of the exact engine: 400 events within it are an accumulation.
inline constexpr double crowd = 1e-9;
/// Of: the length of the run.
/// Why: a control that only passes its threshold is at it for less.
inline constexpr double brief_rest = 1e-6;
/// Of: the length of the run.
/// Why: 450 units of rounding of its times: a segment this short moved nothing.
inline constexpr double no_time = 1e-13;
/// Of: the length of the run.
/// Why: as decays that dense modes do not follow: no row shows what a segment that is over within it has at a diode, and the locator cannot tell that from zero.
inline constexpr double unseen_segment = 1e-9;
/// Of: the length of the run.
/// Why: as `shortest_step`.
inline constexpr double shortest_segment = 1e-15;
/// Of: a segment.
/// Why: halves of halves of it that are shorter have no digits of time.
inline constexpr double shortest_piece = 1e-12;
/// Of: a segment.
/// Why: a guard that is below zero for no longer than this has just passed it.
inline constexpr double just_passed = 1e-4;

// Rounding of sums

/// Of: the magnitudes of the terms of a row.
/// Why: 45 units of rounding: the unknowns that it adds up are as wrong.
inline constexpr double sum_rounding = 1e-14;
/// Of: the largest voltage of the part (of a control, its largest unknown).
/// Why: 45 units of rounding: what a solution leaves of each voltage.
inline constexpr double voltage_rounding = 1e-14;
/// Of: what the resistors at a node carry at the voltage of the sources.
/// Why: five units of rounding: currents that cancel there leave no less.
inline constexpr double node_rounding = 1e-15;
/// Of: the terms of a row of the equations.
/// Why: five units of rounding: refinement makes a solution no better.
inline constexpr double good_backward_error = 1e-15;
/// Of: the largest current.
/// Why: rounding of C/h times a voltage is refined beyond this: six digits of a current are left without it.
inline constexpr double noisy_current = 1e-6;
/// Of: the terms of a row of a segment's vectors.
/// Why: one unit of rounding of double.
inline constexpr double row_rounding = 2e-16;
/// Of: the terms of a residual.
/// Why: half a unit of rounding of double, the error of one operation.
inline constexpr double term_rounding = 1.1e-16;
/// Of: the largest voltage or current of a solution.
/// Why: two units of rounding of double.
inline constexpr double solution_rounding = 4e-16;
/// Of: the largest voltage, and the largest current.
/// Why: the digits that segments have: unknowns below it are zero to the certificate.
inline constexpr double unknown_rounding = 1e-11;
/// Of: the size of a saved signal (PartRun::signal_size).
/// Why: some thousand roundings: a smaller value may be nothing else.
inline constexpr double signal_rounding = 1e-12;

// Signs of ports and controls

/// Of: the size of a margin: of a control its levels and its largest value, of a port its scale, of a slack its terms.
/// Why: some thousand roundings: a margin this small is zero.
inline constexpr double guard_sign = 1e-12;
/// Of: an input, and what resistors carry that alone meet it.
/// Why: three digits, which elimination may lose where its other equation has larger terms; where this is less than the largest input, it counts instead.
inline constexpr double lost_terms = 1e3;
/// Of: the largest input, and the terms of a slack.
/// Why: six digits: a port so far on the wrong side is there by no rounding.
inline constexpr double clear_sign = 1e-6;
/// Of: the largest value of the guard's terms in its segment.
/// Why: the error of a segment: a guard this small where another falls to zero falls with it.
inline constexpr double guard_at_zero = 1e-10;
/// Of: the same as guard_sign, of a port in a passive network, while a step is examined.
/// Why: the exact place is not needed there, and a port at zero is not to end step after step.
inline constexpr double passive_guard_sign = 1e-9;
/// Of: the largest quantity of its kind (u or slack).
/// Why: some 10^5 roundings: the errors of a solution of the equations of a step.
inline constexpr double port_sign = 1e-10;
/// Of: the same in a network that is not passive.
/// Why: a port may drive there what is integrated twice before it answers: its margin counts to the last digits.
inline constexpr double active_port_sign = 1e-12;
/// Of: the same where positions repeat.
/// Why: ties of zero with zero, and the rounding of long chains, decide nothing.
inline constexpr double tied_port_sign = 1e-8;
/// Of: the largest input, and the terms of a slack.
/// Why: as `port_sign`: a port with both at zero is in dispute.
inline constexpr double tied_port = 1e-10;
/// Of: the scale of voltages for currents (times R0), and the other way round.
/// Why: where one kind is still zero, the other says what counts.
inline constexpr double cross_scale = 1e-3;
/// Of: the largest voltage, or current.
/// Why: as `port_sign`: what a port holds at zero is zero.
inline constexpr double held_port = 1e-10;
/// Of: the largest unknown.
/// Why: ten times `held_port`: what ε of a factor adds to it in a position that fits.
inline constexpr double held_row = 1e-9;
/// Of: what a closing row missed before its corrections.
/// Why: three corrections by a factor with ε make nothing of what fits; what contradicts stays.
inline constexpr double contradiction = 1e-3;
/// Of: the largest u times the largest s, for the mean of u s.
/// Why: the square of `port_sign`: each port has one of both at zero.
inline constexpr double interior_gap = 1e-20;
/// Of: the largest u, and the largest s.
/// Why: as `port_sign`.
inline constexpr double interior_residual = 1e-10;
/// Of: the largest u, and the largest s.
/// Why: the first point must be well inside.
inline constexpr double interior_start = 1e-3;

// Factors

/// Of: a shift 1/(d h).
/// Why: steps that are sums of halves differ by rounding: the factor is the same.
inline constexpr double same_shift = 1e-11;
/// Of: the tolerance of the run, for ε in the closing rows of ports.
/// Why: what ε changes is far below the tolerance, and is taken out again.
inline constexpr double epsilon_share = 1e-3;
/// Of: the same ε.
/// Why: it is added to entries of order one, where six of its digits are left.
inline constexpr double least_epsilon = 1e-10;
/// Of: the same ε.
/// Why: seven digits are right before ε is taken out.
inline constexpr double largest_epsilon = 1e-7;
/// Of: the largest pivot.
/// Why: 14 units of rounding: a smaller pivot may be nothing else.
inline constexpr double doubtful_pivot = 3e-15;
/// Of: a component of a known solution.
/// Why: a pivot that is rounding returns something of order one; small pivots of different units do not.
inline constexpr double recovered = 1e-3;
/// Of: the terms of a row.
/// Why: the digits of a segment: an updated factor that is worse is made anew.
inline constexpr double update_residual = 1e-11;
/// Of: one, as the reciprocal condition of the small matrix of an update.
/// Why: four digits are lost, and eleven are left.
inline constexpr double update_condition = 1e-4;
/// Of: R0 of the part.
/// Why: the conductance of a smaller resistor takes the digits of others at its nodes: its current is an unknown.
inline constexpr double low_resistance = 1e-6;
/// Of: the admittance around a port.
/// Why: a share that ties what is free, and moves nothing else.
inline constexpr double tie_share = 1e-3;
/// Of: the largest voltage in a loop of capacitors.
/// Why: 450 units of rounding: initial values that differ by more contradict each other.
inline constexpr double capacitor_loop = 1e-13;
/// Of: the largest capacitance that joins a set of nodes.
/// Why: the rounding of a larger one's charge takes three digits of a smaller one's: they are in rows of their own.
inline constexpr double small_capacitor = 1e-3;
/// Of: the largest conductance that joins a set of nodes.
/// Why: the rounding of a larger one's current takes five digits of a smaller one's: what leaves the set is in a row of its own.
inline constexpr double small_conductance = 1e-5;
/// Of: one, as a coupling coefficient.
/// Why: a larger |k| counts as 1: the currents of the two inductors are not independent states.
inline constexpr double perfect_coupling = 1.0 - 1e-9;

// States, start, jumps

/// Of: the largest state of its kind so far (of the other kind, times R0).
/// Why: a state that never was larger is measured against it.
inline constexpr double least_of_kind = 1e-3;
/// Of: the largest voltage of a node.
/// Why: a capacitor that has less is measured against this share: its rounding is that of the nodes.
inline constexpr double node_share = 1e-6;
/// Of: the largest source and initial value.
/// Why: states of that size are not small.
inline constexpr double least_scale = 1e-3;
/// Of: the largest voltage, and the largest current.
/// Why: a state that moves by less is at its DC operating point, to nine digits.
inline constexpr double dc_rest = 1e-9;
/// Of: the largest state of either kind.
/// Why: a kind that is smaller is measured against this share.
inline constexpr double dc_least = 1e-3;
/// Of: a state.
/// Why: a state that moves by less at an instant does not jump; a segment's errors are a hundredth of it.
inline constexpr double jump = 1e-8;
/// Of: the largest √energy.
/// Why: as `unknown_rounding`: the same of all states together.
inline constexpr double jump_energy = 1e-11;
/// Of: a state, after a jump.
/// Why: from where a jump led there is no other but by rounding of its impulses.
inline constexpr double second_jump = 1e-6;
/// Of: the largest √energy.
/// Why: two ways to compute a jump that agree to it agree.
inline constexpr double same_jump = 1e-9;
/// Of: the largest impulse of an instant.
/// Why: smaller ones are not told.
inline constexpr double told_impulse = 1e-6;
/// Of: the largest impulse in a voltage, and in the current of a port.
/// Why: impulses are differences of large unknowns.
inline constexpr double impulse_rounding = 1e-9;
/// Of: the same.
/// Why: a thousand times `impulse_rounding`: one that is larger is none of rounding.
inline constexpr double visible_impulse = 1e-6;
/// Of: the largest of all unknowns, in volts.
/// Why: what one kind makes of the other in a solution.
inline constexpr double other_rounding = 1e-12;
/// Of: the unknowns at the end of the step that impulses are a part of, and the largest impulse of a voltage or current.
/// Why: as `unknown_rounding`.
inline constexpr double step_rounding = 1e-11;

// Segments

/// Of: the largest input.
/// Why: inputs are solved for from differences of voltages: two digits less than `voltage_rounding`.
inline constexpr double input_rounding = 1e-12;
/// Of: the voltages before a jump.
/// Why: 450 units of rounding: states behind it are their differences.
inline constexpr double jump_rounding = 1e-13;
/// Of: the norms of a guard's row and of the state.
/// Why: five units of rounding: what is left of a decay where it is taken out of a row.
inline constexpr double left_of_decay = 1e-15;
/// Of: the row of the largest voltage, or input.
/// Why: 450 units of rounding: a smaller row is zero.
inline constexpr double empty_row = 1e-13;
/// Of: the largest voltage, or input.
/// Why: a larger row counts, however many digits orthogonalisation has cost.
inline constexpr double largest_empty_row = 1e-8;
/// Of: the largest voltage, and the largest current.
/// Why: a segment whose vectors leave more to rounding is made shorter.
inline constexpr double known_digits = 1e-10;
/// Of: the largest √energy.
/// Why: a segment longer than it was made for may not lose more.
inline constexpr double lengthened_rounding = 1e-11;
/// Of: the largest √energy.
/// Why: five units of rounding: what a solution leaves of the rest in a store that has nothing to do with it.
inline constexpr double at_rest = 1e-15;
/// Of: the largest voltage.
/// Why: 450 units of rounding: a store with less is empty.
inline constexpr double empty_store = 1e-13;
/// Of: the largest voltage.
/// Why: what sums of some hundred vectors leave in such a store.
inline constexpr double moved_store = 1e-11;
/// Of: the largest √energy.
/// Why: beyond it the states that a segment begins with are not those that were given.
inline constexpr double start_rounding = 1e-8;
/// Of: the largest √energy.
/// Why: an estimate that is below it and does not shrink is rounding of the vectors.
inline constexpr double converged_rounding = 1e-9;
/// Of: the largest √energy.
/// Why: ten tolerances of a segment: where an estimate above it does not shrink, more vectors are tried before it counts as rounding.
inline constexpr double plain_rounding = 1e-12;
/// Of: an error's part of the largest √energy, as its part of a state's size.
/// Why: an error beneath 1e-15 of the whole is rounding of the vectors, and to ask for less lets segments end in it (at 1e3 a rectifier is 1e-7 off for 5e-9).
inline constexpr double most_weight_of_error = 1e2;
/// Of: the largest value of a signal on a piece.
/// Why: as `known_digits`: a polynomial has no more digits than the segment.
inline constexpr double piece_resolution = 1e-10;
/// Of: T z, for what is left of it beside the other vectors.
/// Why: what is smaller is mostly the rounding of T z; where it is far above that, it is taken if the estimate asks for it.
inline constexpr double new_direction = 1e-10;
/// Of: z, for the same.
/// Why: five units of rounding.
inline constexpr double least_direction = 1e-15;
/// Of: z, for the rounding of T z.
/// Why: 450 units of rounding: less is not looked at more closely.
inline constexpr double little_direction = 1e-13;
/// Of: the √energy that counts.
/// Why: a correction this small is the last.
inline constexpr double refined_solution = 1e-15;
/// Of: the √energy that counts.
/// Why: the solution that begins a segment may be wrong by that without a closer look.
inline constexpr double first_solution = 1e-9;
/// Of: one, as the condition of K.
/// Why: beyond it four digits are left, and the space is nothing but rounding.
inline constexpr double largest_condition = 1e12;
/// Of: the largest deviation so far.
/// Why: a segment's own tolerance.
inline constexpr double known_deviation = 1e-12;
/// Of: the same.
/// Why: where the vectors are nothing but rounding, half of the digits are left.
inline constexpr double rounded_deviation = 1e-8;
/// Of: the same.
/// Why: its square is below the smallest square of rounding: the deviation has decayed.
inline constexpr double decayed_deviation = 1e-20;
/// Of: the largest shift, or its terms.
/// Why: half of the digits: guards that fall to zero together do so in nearby runs, too.
inline constexpr double same_shift_of_time = 1e-6;

// Certificate

/// Of: the largest term of a part, for a row whose terms never exceed it.
/// Why: the terms of such a row may be rounding errors of the largest term.
inline constexpr double idle_row = 1e-3;
/// Of: one, as the residual of a segment's rows where it begins.
/// Why: with two digits less a run is doubtful: its solutions are then corrected.
inline constexpr double doubtful_rows = 1e-9;
/// Of: one, as the certificate's worst residual of a run of segments.
/// Why: a segment's tolerance is next to rounding: three digits more are lost somewhere.
inline constexpr double doubtful_segments = 1e-7;

// Small signals of linear circuits at 0 Hz

/// Of: the largest time R0·C or L/R0.
/// Why: what takes longer to discharge is a pivot that is rounding of zero, 1e-16 of conductances a thousand times 1/R0.
inline constexpr double longest_discharge = 1e13;
/// Of: one over the largest time R0·C or L/R0.
/// Why: steps of one over it pass time constants with resistances of a thousand times R0, and what grows in them without end leaves ten digits to the rest.
inline constexpr double rate_of_rest = 1e-6;
/// Of: the terms of a signal, of charges at random.
/// Why: what is left of them after the steps is the error of the signal; rounding of the steps is 1e-10.
inline constexpr double moved_by_charge = 1e-8;

}  // namespace pwlsim::engine::sparse::tolerance
