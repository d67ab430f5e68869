#pragma once
/// Converts messages of the rooms to those of the library.

#include <string>
#include <vector>

#include <pwlsim/error.hpp>

#include "base/diagnostic.hpp"

namespace pwlsim::api {

[[nodiscard]] Message message_of(const Diagnostic& diagnostic, const SourceStore& sources = {});
[[nodiscard]] std::vector<Message> messages_of(const Diagnostics& diagnostics, const SourceStore& sources);

/// With one message.
[[nodiscard]] Error error(std::string id, std::string text);

}  // namespace pwlsim::api
