#pragma once
/// Messages on standard error, kept for the statistics.

#include <string>
#include <vector>

#include "analysis/idealisation.hpp"
#include "base/diagnostic.hpp"

namespace pwlsim::cli {

/// Writes bytes to standard error and ignores failures.
void say(const std::string& text);

class Messages {
 public:
  explicit Messages(bool quiet) : quiet_(quiet) {}

  /// Prints errors always, notes and warnings unless quiet.
  void report(const Diagnostics& diagnostics, const SourceStore& sources);
  /// The same for one message, unless it was printed before.
  void report(const Diagnostic& diagnostic, const SourceStore& sources = {});
  /// Kept for the statistics, and not printed.
  void keep(const Diagnostic& diagnostic);
  /// Printed unless quiet; not kept.
  void remark(const std::string& text) const;

  /// The first line of every message so far.
  [[nodiscard]] const std::vector<std::string>& heads() const { return heads_; }
  /// The places where the deck does not run as written.
  [[nodiscard]] const std::vector<analysis::Idealisation>& departures() const { return departures_; }

 private:
  bool quiet_;
  std::vector<std::string> heads_;
  std::vector<analysis::Idealisation> departures_;
};

}  // namespace pwlsim::cli
