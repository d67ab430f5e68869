#include "api/messages.hpp"

#include <algorithm>
#include <utility>

namespace pwlsim {
namespace {

std::string text_of_errors(const std::vector<Message>& messages) {
  std::string text;
  for (const Message& message : messages)
    if (message.kind == Message::Kind::error) text += message.full;
  return text;
}

std::string id_of(const std::vector<Message>& messages) {
  const auto first = std::find_if(messages.begin(), messages.end(), [](const Message& m) { return m.kind == Message::Kind::error; });
  return first == messages.end() ? "" : first->id;
}

}  // namespace

Error::Error(std::vector<Message> messages)
    : std::runtime_error(text_of_errors(messages)), messages_(std::move(messages)), id_(id_of(messages_)) {}

namespace api {

Message message_of(const Diagnostic& diagnostic, const SourceStore& sources) {
  const auto kind = diagnostic.severity == Severity::error     ? Message::Kind::error
                    : diagnostic.severity == Severity::warning ? Message::Kind::warning
                                                               : Message::Kind::note;
  return {kind, diagnostic.id, diagnostic.text, render(diagnostic, sources)};
}

std::vector<Message> messages_of(const Diagnostics& diagnostics, const SourceStore& sources) {
  std::vector<Message> messages;
  for (const Diagnostic& diagnostic : diagnostics.all()) messages.push_back(message_of(diagnostic, sources));
  return messages;
}

Error error(std::string id, std::string text) { return Error({message_of({Severity::error, std::move(id), {}, std::move(text)})}); }

}  // namespace api
}  // namespace pwlsim
