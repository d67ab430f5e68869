#pragma once
/// User-facing messages as data: collected, never thrown; rendered at the very end.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/source.hpp"

namespace pwlsim {

enum class Severity { note, warning, error };

/// `id` is stable and carries its letter: "E-unknown-node", "W-…", "N-…".
/// `text` is one sentence, with "; try …" at its end if there is a fix.
struct Diagnostic {
  Severity severity = Severity::error;
  std::string id;
  SourceSpan span;
  std::string text;
};

class Diagnostics {
 public:
  void error(std::string id, SourceSpan span, std::string text);
  void warning(std::string id, SourceSpan span, std::string text);
  void note(std::string id, SourceSpan span, std::string text);

  /// Errors for which `accepts` returns true, and may give another id and text, become warnings. Returns how many.
  std::size_t soften(const std::function<bool(Diagnostic&)>& accepts);

  [[nodiscard]] bool has_errors() const { return errors_ != 0; }
  [[nodiscard]] std::size_t error_count() const { return errors_; }
  [[nodiscard]] const std::vector<Diagnostic>& all() const { return list_; }

 private:
  std::vector<Diagnostic> list_;
  std::size_t errors_ = 0;
};

/// `file:line:column: error[E-id]: text`, then the source line and a caret line under the span.
/// Without a known span: `error[E-id]: text`. Control characters and overlong lines are made printable and shortened.
[[nodiscard]] std::string render(const Diagnostic& diagnostic, const SourceStore& sources);

/// The candidate nearest to `name` (case-insensitive edit distance, at most a third of its length), or "" if none is near.
[[nodiscard]] std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace pwlsim
