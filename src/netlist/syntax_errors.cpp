#include "netlist/syntax_errors.hpp"

#include <algorithm>
#include <utility>

namespace pwlsim::netlist {

bool SyntaxErrors::is_shown(Severity severity, const std::string& id, SourceSpan span) {
  constexpr std::size_t most_shown = 100;
  const bool known = std::any_of(shown_.begin(), shown_.end(), [&](const Diagnostic& d) { return d.span == span && d.id == id; });
  if (known) {
    return false;
  }
  if (shown_.size() == most_shown) {
    held_back_ += severity == Severity::error ? 1 : 0;
    return false;
  }
  shown_.push_back({severity, id, span, {}});
  return true;
}

void SyntaxErrors::report(std::string id, SourceSpan span, std::string text) {
  ++count_;
  if (is_shown(Severity::error, id, span)) {
    diagnostics_.error(std::move(id), span, std::move(text));
  }
}

void SyntaxErrors::note(std::string id, SourceSpan span, std::string text) {
  if (is_shown(Severity::note, id, span)) {
    diagnostics_.note(std::move(id), span, std::move(text));
  }
}

void SyntaxErrors::finish() {
  if (held_back_ != 0) {
    diagnostics_.error("E-syntax-more", {}, std::to_string(held_back_) + " more syntax errors are not shown");
  }
}

}  // namespace pwlsim::netlist
