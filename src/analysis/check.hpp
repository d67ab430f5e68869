#pragma once
/// A second opinion on a run: the other engine, refined until its own answer stands, beside the rows that were written.
///
/// The sparse engine shares neither extraction, modes, selection nor event search with the exact one. It runs at reltol 1e-4, 1e-5, …; of
/// each signal, relative to its maximum,
///   difference D: the largest |row − sparse| of the rows, at the finest level;
///   error e: what the changes from level to level leave (base/remainder.hpp), at least the level's reltol.
/// Where the other engine has an event within two thousandths of a row step of a row, both sides of it count: D is then the distance of the row from the range of the
/// other's values within a thousandth of a row step (a signal that jumps may stand on either side).
///
///   agrees:   D ≤ 2 e + rounding, and e ≤ 1e-3
///   differs:  D > 2 e + rounding, and e ≤ D/10, at two levels one after the other
///   no verdict otherwise: the sparse engine has not converged.
///
/// Rounding is 1e-9 of the signal, or of the largest signal of its unit, whichever is more. A run by the sparse engine is checked by one of the exact engine where the circuit's size allows, else
/// by the sparse engine at a tenth and a hundredth of the tolerance; it agrees where D is at most a hundred tolerances (docs/reference/engines.md).

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
  double reltol = 0.0;  ///< 0 of the exact engine
  double seconds = 0.0;
  std::string failure;  ///< "" where it reached the end
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
  std::string reason;    ///< of the verdict, a sentence without it
  std::size_t rows = 0;  ///< compared
  std::vector<CheckLevel> levels;
  std::vector<CheckedSignal> signals;  ///< none where no level reached the end
};

struct CheckSettings {
  std::string engine;     ///< of the run: "exact" or "sparse"
  double reltol = 0.0;    ///< of a sparse run
  double seconds = 20.0;  ///< of wall time, in all
  const std::atomic<int>* interrupt = nullptr;
};

/// `rows`: those of a run of `compiled.analyses.transient` that reached its end.
[[nodiscard]] Check check_run(const circuit::Compiled& compiled, const KeptRows& rows, const CheckSettings& settings);

/// "agrees: …", and a line a signal.
[[nodiscard]] std::string check_text(const Check& check);

/// The member `check`; null without one.
void write_check(JsonWriter& json, const Check* check);

}  // namespace pwlsim::analysis
