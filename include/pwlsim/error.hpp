#pragma once
/// What the library has to say, and the exceptions by which it refuses.

#include <stdexcept>
#include <string>
#include <vector>

namespace pwlsim {

/// One message. The ids do not change between versions and stand in docs/reference/messages.md, each with its cure.
struct Message {
  enum class Kind { note, warning, error };
  Kind kind = Kind::error;
  std::string id;    ///< "E-unknown-model", "W-…", "N-…"
  std::string text;  ///< one sentence, with "; try …" where there is a cure
  std::string full;  ///< with its place, and the line it is about: "code:4:12: error[E-unknown-model]: …\nD1 a b DX\n       ^~\n"
};

/// The circuit is wrong, or something was asked that is not there. what() holds the full text of all errors.
class Error : public std::runtime_error {
 public:
  /// `messages` has an error.
  explicit Error(std::vector<Message> messages);

  /// Of the first error.
  [[nodiscard]] const std::string& id() const noexcept { return id_; }
  /// All there are, warnings and notes too.
  [[nodiscard]] const std::vector<Message>& messages() const noexcept { return messages_; }

 private:
  std::vector<Message> messages_;
  std::string id_;
};

}  // namespace pwlsim
