#pragma once
/// Messages of the rooms as the library hands them out.

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
