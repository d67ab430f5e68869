#pragma once
/// A deck run in process, from its text to the values of its rows.

#include <filesystem>
#include <string>
#include <vector>

#include "engine/run.hpp"

namespace pwlsim::test {

struct DeckRun {
  std::string messages;  ///< rendered diagnostics that are errors; the rest is empty then
  std::vector<std::string> signals;
  std::vector<std::vector<double>> rows;  ///< time, then one value a signal
  double stop = 0.0;
  engine::Answer answer;

  /// The first row at exactly `time`; null where there is none.
  [[nodiscard]] const std::vector<double>* row_at(double time) const;
};

/// `events`: rows before and after every event as well. The deck must have a .tran card.
[[nodiscard]] DeckRun run_deck(const std::filesystem::path& path, bool events = false);
/// The same on the exact engine, with something that goes wrong on purpose.
[[nodiscard]] DeckRun run_deck_with_faults(const std::filesystem::path& path, const engine::Request::Faults& faults);
/// The same on the sparse engine.
[[nodiscard]] DeckRun run_deck_sparse(const std::filesystem::path& path, double reltol, bool events = false);
/// The same by exact segments (`--engine krylov`).
[[nodiscard]] DeckRun run_deck_segments(const std::filesystem::path& path);
/// The same for a deck in memory, on a model whose leaks are the conductances that they are written as (model/leaks.hpp).
[[nodiscard]] DeckRun run_text_with_leaks_as_written(const std::string& text);
/// The same for a deck in memory.
[[nodiscard]] DeckRun run_text(const std::string& text, bool events = false);
[[nodiscard]] DeckRun run_text_segments(const std::string& text, bool events = false);
[[nodiscard]] DeckRun run_text_sparse(const std::string& text, double reltol, bool events = false);

}  // namespace pwlsim::test
