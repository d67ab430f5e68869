#pragma once
/// A run of a deck against its reference.

#include <filesystem>
#include <string>
#include <vector>

#include "regression/deck_run.hpp"

namespace pwlsim::test {

struct Reference;

/// Decks of a folder, by name, in order.
[[nodiscard]] std::vector<std::filesystem::path> decks_in(const std::string& folder);

struct Bounds {
  double value = 1e-9;  ///< of a signal, relative to its largest reference value
  double time = 1e-12;  ///< of an event, relative to the length of the run
  bool touch = false;   ///< the deck only touches a threshold: the touch may count as an event or not
};

/// Checks with Catch2: rows, rows around events, event times and their count, certificate.
void compare_with_reference(const std::filesystem::path& deck, const Bounds& bounds);

/// The worst error over the signals and all rows, of each signal's largest value, but those at an instant that the reference names.
[[nodiscard]] double worst_error(const DeckRun& run, const Reference& reference);

/// A deck by dense modes and by Krylov segments, which share no equations. Requires that both complete.
struct BothRuns {
  DeckRun modes, segments;
};
[[nodiscard]] BothRuns run_both(const std::string& deck);

/// The largest difference of two runs' rows, of each signal's largest value in the first, which counts as `least` at least. Requires as many rows of both.
[[nodiscard]] double largest_difference(const DeckRun& one, const DeckRun& other, double least = 0.0);

}  // namespace pwlsim::test
