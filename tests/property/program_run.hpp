#pragma once
/// One run of the program on a network, with uic.

#include <string>
#include <vector>

#include "engine/run.hpp"
#include "model/network.hpp"
#include "property/random_network.hpp"

namespace pwlsim::test {

struct Finding {
  enum class Kind { fine, refused, wrong };
  Kind kind = Kind::fine;
  std::string what;    ///< of a wrong one: which property, a few words; of a refused one the id of the diagnostic
  std::string detail;  ///< numbers, for people
  engine::Certificate certificate = {};
};

struct ProgramRun {
  Finding finding;                        ///< `refused`: the linear equations are singular
  std::vector<std::vector<double>> rows;  ///< time, signals
  engine::Answer answer;
};

/// Rows at `times`, ascending; the run ends with the last. `events`: a row before and after each event as well.
[[nodiscard]] ProgramRun run_program(const model::Network& network, const std::vector<double>& times, bool events = false);

/// The same on the sparse engine. `refused`: it says that it cannot do this (impulses of higher order).
[[nodiscard]] ProgramRun run_program_sparse(const model::Network& network, const std::vector<double>& times, double reltol);

/// The same by exact segments (`--engine krylov`); `shift_factor` as engine::sparse::run_segments.
[[nodiscard]] ProgramRun run_program_segments(const model::Network& network, const std::vector<double>& times, double shift_factor = 1.0);

/// Where states are smaller than this all the time nothing is there but rounding.
struct LeastStates {
  double voltage = 0.0, current = 0.0;
};
/// The largest distance of the states of two runs of a network, whose rows hold them in its order, in the norm of the stored energy, of the largest of that,
/// the start included.
[[nodiscard]] double energy_distance(const RandomNetwork& network, const ProgramRun& a, const ProgramRun& b, LeastStates least = {});

}  // namespace pwlsim::test
