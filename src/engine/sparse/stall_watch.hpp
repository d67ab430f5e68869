#pragma once
/// Detects steps of a block without progress. If no solution continues, they may get ever shorter from one wrong position to the next, or ports
/// find no valid position: an active network need not have a solution, and a passive one may contain a short circuit of ideal parts.

#include <cstdint>
#include <string>

#include "engine/run.hpp"

namespace pwlsim::engine::sparse {

class StallWatch {
 public:
  StallWatch(bool is_passive, double stop, double reltol);

  /// The time of the run, s, and the number of steps and events so far.
  struct Progress {
    double time = 0.0;
    std::uint64_t steps = 0, events = 0;
  };

  /// A step of length h was accepted with `error`, a longer one rejected with `rejected_error`.
  void note_errors(double error, double rejected_error);
  /// An instant at which ports changed sides, and whether it had an effect.
  void note_instant(bool happened);
  /// Whether too many consecutive instants had no effect.
  [[nodiscard]] int idle_passages() const { return idle_passages_; }

  /// Whether it is time to examine the last steps.
  [[nodiscard]] bool is_due(const Progress& now) const;
  /// The fault of the last steps, as text; empty if they make progress.
  [[nodiscard]] std::string look(const Certificate& certificate, const Progress& now);

 private:
  [[nodiscard]] bool are_steps_many(const Progress& now) const;
  [[nodiscard]] bool are_passages_idle() const;
  [[nodiscard]] std::string look_at_steps(const Certificate& certificate, const Progress& now, double stretch);
  [[nodiscard]] std::string look_at_passages(const Certificate& certificate, const Progress& now);
  [[nodiscard]] bool is_hopeless(double residual) const;

  bool passive_;
  double stop_, reltol_;
  Progress last_;                 ///< of the last look
  double residual_before_ = 0.0;  ///< there
  std::uint64_t cliffs_ = 0;      ///< steps since then whose error jumped with their length
  std::uint64_t idle_since_ = 0;  ///< instants since then that came to nothing
  int idle_passages_ = 0;         ///< the same in a row
  int idle_looks_ = 0;            ///< looks in a row that saw many such instants
  int cliff_looks_ = 0;           ///< and many cliffs
  int stuck_looks_ = 0;           ///< and steps that got nowhere
};

}  // namespace pwlsim::engine::sparse
