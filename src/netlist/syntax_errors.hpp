#pragma once
/// Passes syntax errors to the user's messages: each once, and a limited number.

#include <cstddef>
#include <string>

#include "base/diagnostic.hpp"

namespace pwlsim::netlist {

class SyntaxErrors {
 public:
  explicit SyntaxErrors(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  /// Passes the error on, unless the same was reported (a file may be read twice) or there are a hundred already.
  void report(std::string id, SourceSpan span, std::string text);
  /// The same for notes and warnings.
  void note(std::string id, SourceSpan span, std::string text);
  /// Reports how many errors were held back, if any.
  void finish();

  /// The number of all errors, shown or not.
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] Diagnostics& diagnostics() { return diagnostics_; }

 private:
  /// False if it was reported already, or must be held back.
  bool is_shown(Severity severity, const std::string& id, SourceSpan span);

  Diagnostics& diagnostics_;
  std::vector<Diagnostic> shown_;
  std::size_t count_ = 0;
  std::size_t held_back_ = 0;
};

}  // namespace pwlsim::netlist
