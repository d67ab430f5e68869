#pragma once
/// Messages and exceptions of the library.

#include <stdexcept>
#include <string>
#include <vector>

namespace pwlsim {

/// One message. The ids do not change between versions; docs/reference/messages.md lists them, each with a fix.
struct Message {
  enum class Kind { note, warning, error };
  Kind kind = Kind::error;
  std::string id;    ///< "E-unknown-model", "W-…", "N-…"
  std::string text;  ///< one sentence, with "; try …" if there is a fix
  std::string full;  ///< with its location and the line: "code:4:12: error[E-unknown-model]: …\nD1 a b DX\n       ^~\n"
};

/// The circuit has mistakes, or something requested does not exist. what() holds the full text of all errors.
class Error : public std::runtime_error {
 public:
  /// `messages` must contain an error.
  explicit Error(std::vector<Message> messages);

  /// The id of the first error.
  [[nodiscard]] const std::string& id() const noexcept { return id_; }
  /// All messages, including warnings and notes.
  [[nodiscard]] const std::vector<Message>& messages() const noexcept { return messages_; }

 private:
  std::vector<Message> messages_;
  std::string id_;
};

}  // namespace pwlsim
