#include "analysis/json.hpp"

#include <fmt/format.h>

#include <cmath>

#include "waveform/csv.hpp"

namespace pwlsim::analysis {

std::string json_string(std::string_view text) {
  std::string result = "\"";
  for (const char character : text) {
    if (character == '"' || character == '\\') {
      result += '\\';
      result += character;
    } else if (static_cast<unsigned char>(character) < 0x20) {
      result += fmt::format("\\u{:04x}", static_cast<unsigned char>(character));
    } else {
      result += character;
    }
  }
  return result + '"';
}

std::string json_number(double value) { return std::isfinite(value) ? waveform::shortest(value) : "null"; }

std::string json_truth(bool value) { return value ? "true" : "false"; }

std::string json_line(const std::vector<std::string>& members) {
  std::string result = "[";
  for (const std::string& member : members) result += (result.size() == 1 ? "" : ", ") + member;
  return result + ']';
}

std::string json_line(std::initializer_list<std::pair<std::string_view, std::string>> members) {
  std::string result = "{";
  for (const auto& [key, value] : members) result += fmt::format("{}{}: {}", result.size() == 1 ? "" : ", ", json_string(key), value);
  return result + '}';
}

void JsonWriter::key(std::string_view name) {
  separate();
  text_ += json_string(name) + ": ";
  after_key_ = true;
}

void JsonWriter::value(std::string_view text) {
  separate();
  text_ += text;
}

void JsonWriter::begin(char bracket) {
  separate();
  text_ += bracket;
  ++depth_;
  first_ = true;
}

void JsonWriter::end(char bracket) {
  --depth_;
  if (!first_) break_line();
  text_ += bracket;
  first_ = false;
}

void JsonWriter::separate() {
  if (after_key_) {
    after_key_ = false;
    return;
  }
  if (!first_) text_ += ',';
  first_ = false;
  if (depth_ > 0) break_line();
}

void JsonWriter::break_line() {
  text_ += '\n';
  text_.append(2 * static_cast<std::size_t>(depth_), ' ');
}

}  // namespace pwlsim::analysis
