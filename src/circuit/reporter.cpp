#include "circuit/reporter.hpp"

#include <fmt/format.h>

namespace pwlsim::circuit {

void Reporter::pass(Diagnostic diagnostic) {
  if (full()) return;
  const SourceSpan& span = diagnostic.span;
  if (diagnostic.severity == Severity::note && without_notes_.contains(span.file)) return;
  if (!passed_.insert(fmt::format("{}:{}:{}:{}:{}", diagnostic.id, span.file, span.begin, span.end, diagnostic.text)).second) return;
  switch (diagnostic.severity) {
    case Severity::note:
      diagnostics_.note(std::move(diagnostic.id), span, std::move(diagnostic.text));
      return;
    case Severity::warning:
      diagnostics_.warning(std::move(diagnostic.id), span, std::move(diagnostic.text));
      return;
    case Severity::error:
      diagnostics_.error(std::move(diagnostic.id), span, std::move(diagnostic.text));
      break;
  }
  ++errors_;
  if (full()) diagnostics_.error("E-too-many-errors", {}, fmt::format("{} errors: the rest is not shown", most_errors));
}

void Reporter::forward(const Diagnostics& scratch, bool errors_only) {
  for (const Diagnostic& diagnostic : scratch.all()) {
    if (!errors_only || diagnostic.severity == Severity::error) pass(diagnostic);
  }
}

std::string Reporter::where(const SourceSpan& span) const {
  if (!span.known() || sources_ == nullptr) return "";
  return fmt::format("{}:{}", sources_->name(span.file), sources_->position(span.file, span.begin).line);
}

std::string suggestion(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string nearest = nearest_name(name, candidates);
  return nearest.empty() ? "" : fmt::format("; try '{}'", nearest);
}

}  // namespace pwlsim::circuit
