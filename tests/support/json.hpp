#pragma once
/// Reads JSON after RFC 8259, so that tests see whether a text is valid and what it says. Throws where it is not.

#include <charconv>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace pwlsim::test {

struct Json {
  enum class Kind { null, truth, number, string, array, object };
  Kind kind = Kind::null;
  bool truth = false;
  double number = 0.0;
  std::string string;
  std::vector<Json> array;
  std::map<std::string, Json> object;

  const Json& operator[](const std::string& key) const { return object.at(key); }
  const Json& operator[](std::size_t index) const { return array.at(index); }
};

class JsonReader {
 public:
  explicit JsonReader(std::string_view text) : text_(text) {}

  Json read() {
    Json value = read_value();
    skip_blanks();
    if (at_ != text_.size()) fail();
    return value;
  }

 private:
  [[noreturn]] void fail() const { throw std::runtime_error("no JSON at character " + std::to_string(at_)); }
  void skip_blanks() {
    while (at_ < text_.size() && std::string_view(" \t\n\r").find(text_[at_]) != std::string_view::npos) ++at_;
  }
  bool take(char c) {
    skip_blanks();
    if (at_ == text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!take(c)) fail();
  }
  bool take_word(std::string_view word) {
    skip_blanks();
    if (text_.substr(at_, word.size()) != word) return false;
    at_ += word.size();
    return true;
  }

  Json read_value() {
    Json value;
    if (take('{')) {
      value.kind = Json::Kind::object;
      if (take('}')) return value;
      do {
        std::string key = read_string();
        expect(':');
        if (!value.object.emplace(std::move(key), read_value()).second) fail();
      } while (take(','));
      expect('}');
    } else if (take('[')) {
      value.kind = Json::Kind::array;
      if (take(']')) return value;
      do value.array.push_back(read_value());
      while (take(','));
      expect(']');
    } else if (take_word("true") || take_word("false")) {
      value.kind = Json::Kind::truth;
      value.truth = text_[at_ - 2] == 'u';
    } else if (!take_word("null")) {
      skip_blanks();
      return at_ < text_.size() && text_[at_] == '"' ? string_value() : number_value();
    }
    return value;
  }
  Json string_value() {
    Json value;
    value.kind = Json::Kind::string;
    value.string = read_string();
    return value;
  }
  Json number_value() {
    Json value;
    value.kind = Json::Kind::number;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value.number);
    const std::size_t length = static_cast<std::size_t>(end - text_.data()) - at_;
    const std::string_view number = text_.substr(at_, length);
    if (error != std::errc() || number.find_first_of("infa") != std::string_view::npos || number.back() == '.') fail();
    at_ += length;
    return value;
  }
  std::string read_string() {
    expect('"');
    std::string result;
    while (at_ < text_.size() && text_[at_] != '"') {
      if (static_cast<unsigned char>(text_[at_]) < 0x20) fail();
      if (text_[at_] != '\\') {
        result += text_[at_++];
        continue;
      }
      const char escape = ++at_ < text_.size() ? text_[at_++] : '"';
      if (escape == 'u') {
        result += '?';
        at_ += 4;
      } else if (std::string_view("\"\\/bfnrt").find(escape) != std::string_view::npos) {
        result += escape;
      } else {
        fail();
      }
    }
    expect('"');
    return result;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

inline Json read_json(std::string_view text) { return JsonReader(text).read(); }

}  // namespace pwlsim::test
