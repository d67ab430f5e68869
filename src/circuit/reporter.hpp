#pragma once
/// Passes messages of the circuit room to the user's Diagnostics: each once, however often its card is expanded.

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_set>

#include "base/diagnostic.hpp"
#include "base/source.hpp"

namespace pwlsim::circuit {

class Reporter {
 public:
  Reporter(Diagnostics& diagnostics, const SourceStore& sources) : diagnostics_(diagnostics), sources_(&sources) {}
  /// For circuits without text.
  explicit Reporter(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  void error(std::string id, SourceSpan span, std::string text) { pass({Severity::error, std::move(id), span, std::move(text)}); }
  void warning(std::string id, SourceSpan span, std::string text) { pass({Severity::warning, std::move(id), span, std::move(text)}); }
  void note(std::string id, SourceSpan span, std::string text) { pass({Severity::note, std::move(id), span, std::move(text)}); }
  void pass(Diagnostic diagnostic);
  /// Passes on all of `scratch`, or only its errors.
  void forward(const Diagnostics& scratch, bool errors_only = false);

  /// Diagnostics::soften of the messages so far.
  std::size_t soften(const std::function<bool(Diagnostic&)>& accepts) { return diagnostics_.soften(accepts); }
  [[nodiscard]] std::size_t error_count() const { return diagnostics_.error_count(); }

  /// Notes about this text are dropped: the user did not write it.
  void leave_out_notes_of(FileIndex file) { without_notes_.insert(file); }

  /// True the first time it is called with `key`: for warnings that are given once in a deck.
  [[nodiscard]] bool first_time(std::string_view key) { return once_.insert(std::string(key)).second; }

  /// A reporter for the same texts that writes elsewhere.
  [[nodiscard]] Reporter beside(Diagnostics& diagnostics) const {
    Reporter other(diagnostics);
    other.sources_ = sources_;
    return other;
  }

  /// Whether there are so many errors that looking for more is useless.
  [[nodiscard]] bool full() const { return errors_ >= most_errors; }
  [[nodiscard]] bool failed() const { return diagnostics_.has_errors(); }
  /// The text at `span`; "" for an unknown place.
  [[nodiscard]] std::string_view text(const SourceSpan& span) const { return sources_ != nullptr ? sources_->text(span) : ""; }
  /// The name of the file that holds `span`; "" for an unknown place.
  [[nodiscard]] std::string file_of(const SourceSpan& span) const {
    return sources_ != nullptr && span.known() ? sources_->name(span.file) : "";
  }
  /// "buck.net:7", or "" for an unknown place.
  [[nodiscard]] std::string where(const SourceSpan& span) const;

 private:
  static constexpr std::size_t most_errors = 1000;

  Diagnostics& diagnostics_;
  const SourceStore* sources_ = nullptr;
  std::unordered_set<std::string> passed_;
  std::unordered_set<std::string> once_;
  std::unordered_set<FileIndex> without_notes_;
  std::size_t errors_ = 0;
};

/// "; try 'name'" for the nearest candidate, or "" if none is near.
[[nodiscard]] std::string suggestion(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace pwlsim::circuit
