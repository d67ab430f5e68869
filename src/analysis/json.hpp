#pragma once
/// JSON text (RFC 8259), indented by two blanks.

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pwlsim::analysis {

/// Quoted and escaped.
[[nodiscard]] std::string json_string(std::string_view text);
/// The shortest text that reads back to the same double; `null` if it is not finite.
[[nodiscard]] std::string json_number(double value);
[[nodiscard]] std::string json_truth(bool value);
/// All members on one line: [1, 2, 3]. `members` are JSON texts.
[[nodiscard]] std::string json_line(const std::vector<std::string>& members);

/// The same for an object: {"a": 1, "b": 2}.
[[nodiscard]] std::string json_line(std::initializer_list<std::pair<std::string_view, std::string>> members);

/// Writes one value, member by member. Every begin needs its end; a member of an object needs its key first.
class JsonWriter {
 public:
  void begin_object() { begin('{'); }
  void begin_array() { begin('['); }
  void end_object() { end('}'); }
  void end_array() { end(']'); }
  void key(std::string_view name);
  /// `text` must be JSON.
  void value(std::string_view text);
  void member(std::string_view name, std::string_view text) {
    key(name);
    value(text);
  }
  [[nodiscard]] std::string take() { return std::move(text_) + '\n'; }

 private:
  void begin(char bracket);
  void end(char bracket);
  void separate();
  void break_line();

  std::string text_;
  int depth_ = 0;
  bool first_ = true;  ///< nothing follows the last bracket yet
  bool after_key_ = false;
};

}  // namespace pwlsim::analysis
