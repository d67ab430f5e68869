#pragma once
/// An independent solution of a random passive network: implicit Euler, every step a network of conductances and ideal diodes
/// (resistive_network.hpp). With x the voltages of capacitors and currents of inductors,
///
///     C (v₁ − v₀)/h = i₁,   L (i₁ − i₀)/h = v₁,   0 ≤ i_D1 ⊥ −v_D1 ≥ 0,   sources and switches as at the end of the step.
///
/// For passive networks it converges to the solution, jumps included, as h → 0 (Han, Tiwari, Camlibel, Pang: Convergence of time-stepping
/// schemes for passive and extended linear complementarity systems, SIAM J. Numer. Anal. 47, 2009), with an error of order h. One step is a
/// contraction in the norm of the stored energy. Solutions of a step may differ in the currents of parallel diodes and the
/// potentials of floating parts but not in x, so that no least norm needs to be chosen; that is checked where positions are few.

#include <string>
#include <vector>

#include "property/random_network.hpp"

namespace pwlsim::test {

/// Times of the coarsest steps in start … stop; each instant at which a source has an edge or corner, or a switch moves, is among them.
struct StepGrid {
  std::vector<double> times;
  std::vector<std::size_t> samples;  ///< indices of the times that are compared: none is such an instant
};

/// About `steps` equal steps, after each edge and after the start a geometric approach to them.
[[nodiscard]] StepGrid make_grid(const RandomNetwork& network, double start, double stop, int steps);

/// Instants in (0, stop) at which a source has an edge or corner, or a switch moves; ascending.
[[nodiscard]] std::vector<double> edges_of(const RandomNetwork& network, double stop);

struct Trajectory {
  std::string problem;                      ///< empty if every step was solved
  std::vector<std::vector<double>> states;  ///< at each sample; in the order of the network's parts
};

/// From `initial` at the first time of the grid, each of whose steps is divided into `division` equal ones. `examine_all`: at the steps in which a
/// diode changes, and at every sixteenth, all positions that solve it must lead to the same states.
[[nodiscard]] Trajectory implicit_euler(const RandomNetwork& network, const StepGrid& grid, std::vector<double> initial, int division,
                                        bool examine_all);

/// The voltage or current that random networks give their sources and stores at most: what rounding is a share of where a state is zero.
[[nodiscard]] double typical_state(const NetworkPart& part);
[[nodiscard]] std::vector<double> initial_states(const RandomNetwork& network);
[[nodiscard]] std::vector<NetworkPart> states_of(const RandomNetwork& network);

}  // namespace pwlsim::test
