#include "netlist/syntax_errors.hpp"

#include <algorithm>
#include <utility>

namespace pwlsim::netlist {

void SyntaxErrors::report(std::string id, SourceSpan span, std::string text) {
  constexpr std::size_t most_shown = 100;
  ++count_;
  const bool known = std::any_of(shown_.begin(), shown_.end(), [&](const Diagnostic& d) { return d.span == span && d.id == id; });
  if (known) {
    return;
  }
  if (shown_.size() == most_shown) {
    ++held_back_;
    return;
  }
  shown_.push_back({Severity::error, id, span, {}});
  diagnostics_.error(std::move(id), span, std::move(text));
}

void SyntaxErrors::finish() {
  if (held_back_ != 0) {
    diagnostics_.error("E-syntax-more", {}, std::to_string(held_back_) + " more syntax errors are not shown");
  }
}

}  // namespace pwlsim::netlist
