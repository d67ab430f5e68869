#pragma once
/// The reference numbers of tests/reference, made by validation/references without any code of the program.

#include <filesystem>
#include <string>
#include <vector>

namespace pwlsim::test {

struct ReferenceEvent {
  double time = 0.0;  ///< s
  std::string what;   ///< "edge", "jump", "+X", "-X", separated by blanks
  std::vector<double> after;

  /// Whether a mode changes or a state jumps. A pure `edge` is a ramp that turns and nothing else (no deck has a source whose jump
  /// changes no mode and no state), which is no event of a run; nor is what happens at t = 0.
  [[nodiscard]] bool counts() const { return what != "corner" && time > 0.0; }
};

struct Reference {
  std::vector<std::string> signals;
  std::vector<std::vector<double>> rows;  ///< time, then one value a signal
  std::vector<ReferenceEvent> events;

  /// The largest magnitude of a signal over rows and events; 1 for a signal that is zero throughout, which only decks in units of one have.
  [[nodiscard]] double maximum(std::size_t signal) const;
};

[[nodiscard]] std::filesystem::path reference_folder();
/// Throws std::runtime_error where NAME.csv or NAME.events.csv is missing or not as expected.
[[nodiscard]] Reference read_reference(const std::string& name);

/// Signals and rows of one file, without events.
[[nodiscard]] Reference read_rows(const std::filesystem::path& path);

}  // namespace pwlsim::test
