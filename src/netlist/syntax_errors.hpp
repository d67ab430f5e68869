#pragma once
/// Syntax errors on their way to the user's messages: each once, and not without end.

#include <cstddef>
#include <string>

#include "base/diagnostic.hpp"

namespace pwlsim::netlist {

class SyntaxErrors {
 public:
  explicit SyntaxErrors(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  /// Passes the error on, unless the same was reported (a file may be read twice) or a hundred stand already.
  void report(std::string id, SourceSpan span, std::string text);
  /// What is told and passes, likewise.
  void note(std::string id, SourceSpan span, std::string text);
  /// Says how many errors were held back, if any.
  void finish();

  /// All errors met, shown or not.
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] Diagnostics& diagnostics() { return diagnostics_; }

 private:
  /// False where it is known already, or must be held back.
  bool is_shown(Severity severity, const std::string& id, SourceSpan span);

  Diagnostics& diagnostics_;
  std::vector<Diagnostic> shown_;
  std::size_t count_ = 0;
  std::size_t held_back_ = 0;
};

}  // namespace pwlsim::netlist
