#include "cli/messages.hpp"

#include <unistd.h>

#include <algorithm>
#include <utility>

#include "waveform/output_file.hpp"

namespace pwlsim::cli {

void say(const std::string& text) {
  std::size_t written = 0;
  (void)waveform::write_all(STDERR_FILENO, text, written);
}

void Messages::report(const Diagnostics& diagnostics, const SourceStore& sources) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics.all()) {
    const std::string rendered = render(diagnostic, sources);
    heads_.push_back(rendered.substr(0, rendered.find('\n')));
    if (!quiet_ || diagnostic.severity == Severity::error) text += rendered;
  }
  say(text);
  for (analysis::Idealisation& departure : analysis::departures(diagnostics, sources)) departures_.push_back(std::move(departure));
}

void Messages::report(const Diagnostic& diagnostic, const SourceStore& sources) {
  const std::string rendered = render(diagnostic, sources);
  std::string head = rendered.substr(0, rendered.find('\n'));
  if (std::find(heads_.begin(), heads_.end(), head) != heads_.end()) return;
  heads_.push_back(std::move(head));
  if (!quiet_ || diagnostic.severity == Severity::error) say(rendered);
}

void Messages::keep(const Diagnostic& diagnostic) {
  const std::string rendered = render(diagnostic, SourceStore{});
  heads_.push_back(rendered.substr(0, rendered.find('\n')));
}

void Messages::remark(const std::string& text) const {
  if (!quiet_) say(text);
}

}  // namespace pwlsim::cli
