#pragma once
/// What is said on standard error, and kept for the statistics.

#include <string>
#include <vector>

#include "analysis/idealisation.hpp"
#include "base/diagnostic.hpp"

namespace pwlsim::cli {

/// Bytes to standard error; failures have nowhere to go.
void say(const std::string& text);

class Messages {
 public:
  explicit Messages(bool quiet) : quiet_(quiet) {}

  /// Errors are said always, notes and warnings unless quiet.
  void report(const Diagnostics& diagnostics, const SourceStore& sources);
  /// The same for one message, unless it was said before.
  void report(const Diagnostic& diagnostic, const SourceStore& sources = {});
  /// Kept for the statistics, and not said.
  void keep(const Diagnostic& diagnostic);
  /// Said unless quiet; not kept.
  void remark(const std::string& text) const;

  /// The first line of every message so far.
  [[nodiscard]] const std::vector<std::string>& heads() const { return heads_; }
  /// Where the deck does not run as written.
  [[nodiscard]] const std::vector<analysis::Departure>& departures() const { return departures_; }

 private:
  bool quiet_;
  std::vector<std::string> heads_;
  std::vector<analysis::Departure> departures_;
};

}  // namespace pwlsim::cli
