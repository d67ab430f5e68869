#pragma once
/// A second opinion on a run: compares the written rows with the other engine, refined until it has converged.
///
/// The sparse engine shares neither extraction, modes, selection nor event search with the exact one. It runs at reltol 1e-4, 1e-5, …; of
/// each signal, relative to its maximum,
///   difference D: the largest |row − sparse| of the rows, at the finest level;
///   error e: the remaining error by the changes from level to level (base/remainder.hpp), at least the level's reltol.
/// If the other engine has an event within two thousandths of a row step of a row, both sides of it count: D is then the distance of the row from the range of the
/// other's values within a thousandth of a row step (a signal that jumps may be on either side).
///
///   agrees:   D ≤ 2 e + rounding, and e ≤ 1e-3
///   differs:  D > 2 e + rounding, and e ≤ D/10, at two consecutive levels
///   no verdict otherwise: the sparse engine has not converged.
///
/// Rounding is 1e-9 of the signal, or of the largest signal of its unit, whichever is more. A run by the sparse engine is checked by the exact engine if the circuit's size allows it, else
/// by the sparse engine at a tenth and a hundredth of the tolerance; it agrees if D is at most a hundred tolerances (docs/reference/engines.md).

#include <atomic>
#include <string>
#include <vector>

#include "analysis/kept_rows.hpp"
#include "circuit/compile.hpp"

namespace pwlsim::analysis {

class JsonWriter;

enum class Agreement { agrees, differs, undecided };

struct CheckLevel {
  std::string engine;
  double reltol = 0.0;  ///< 0 for the exact engine
  double seconds = 0.0;
  std::string failure;  ///< "" if it reached the end
};

struct CheckedSignal {
  std::string name;
  double scale = 0.0;       ///< its largest magnitude
  double difference = 0.0;  ///< this and the error relative to `scale`
  double time = 0.0;        ///< s, of the difference
  double error = 0.0;       ///< of the other engine, as estimated
  Agreement agreement = Agreement::undecided;
};

struct Check {
  Agreement agreement = Agreement::undecided;
  std::string reason;    ///< the reason of the verdict, as text
  std::size_t rows = 0;  ///< compared
  std::vector<CheckLevel> levels;
  std::vector<CheckedSignal> signals;  ///< none if no level reached the end
};

struct CheckSettings {
  std::string engine;     ///< of the run: "exact" or "sparse"
  double reltol = 0.0;    ///< of a sparse run
  double seconds = 20.0;  ///< of wall time, in all
  const std::atomic<int>* interrupt = nullptr;
};

/// `rows`: those of a run of `compiled.analyses.transient` that reached its end.
[[nodiscard]] Check check_run(const circuit::Compiled& compiled, const KeptRows& rows, const CheckSettings& settings);

/// "agrees: …", and one line per signal.
[[nodiscard]] std::string check_text(const Check& check);

/// The member `check`; null without one.
void write_check(JsonWriter& json, const Check* check);

}  // namespace pwlsim::analysis
