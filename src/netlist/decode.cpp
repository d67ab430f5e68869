#include "netlist/decode.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace pwlsim::netlist {

namespace {

constexpr char32_t replacement = 0xFFFD;
constexpr char32_t no_break_space = 0xA0;

// Windows-1252 from 0x80 to 0x9F; above it is Latin-1. Zero where it has no character.
constexpr std::array<char32_t, 32> windows_1252{0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021, 0x02C6, 0x2030, 0x0160,
                                                0x2039, 0x0152, 0,      0x017D, 0,      0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022,
                                                0x2013, 0x2014, 0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178};

void append_utf8(std::string& text, char32_t c) {
  const auto trail = [&](int shift) { text.push_back(static_cast<char>(0x80U | ((c >> shift) & 0x3FU))); };
  if (c < 0x80) {
    text.push_back(static_cast<char>(c));
  } else if (c < 0x800) {
    text.push_back(static_cast<char>(0xC0U | (c >> 6U)));
    trail(0);
  } else if (c < 0x10000) {
    text.push_back(static_cast<char>(0xE0U | (c >> 12U)));
    trail(6);
    trail(0);
  } else {
    text.push_back(static_cast<char>(0xF0U | (c >> 18U)));
    trail(12);
    trail(6);
    trail(0);
  }
}

struct CodePoint {
  char32_t value = 0;
  std::size_t size = 0;  ///< bytes read; 0 where they are not UTF-8
};

/// The code point at the front, refusing overlong forms, surrogates and values beyond Unicode.
CodePoint read_utf8(std::string_view bytes) {
  const auto lead = static_cast<unsigned char>(bytes[0]);
  if (lead < 0x80) {
    return {lead, 1};
  }
  const std::size_t size = lead < 0xC2 ? 0 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : lead < 0xF5 ? 4 : 0;
  if (size == 0 || bytes.size() < size) {
    return {};
  }
  char32_t value = lead & (0xFFU >> (size + 1));
  for (std::size_t i = 1; i < size; ++i) {
    const auto trail = static_cast<unsigned char>(bytes[i]);
    if ((trail & 0xC0U) != 0x80U) {
      return {};
    }
    value = value << 6U | (trail & 0x3FU);
  }
  constexpr std::array<char32_t, 5> smallest{0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = value >= 0xD800 && value < 0xE000;
  return value < smallest[size] || surrogate || value > 0x10FFFF ? CodePoint{} : CodePoint{value, size};
}

/// Four characters of ASCII in little-endian UTF-16, printable or ends of lines.
bool begins_as_utf16(std::string_view bytes) {
  constexpr std::size_t looked_at = 8;
  if (bytes.size() < looked_at || bytes.size() % 2 != 0) return false;
  for (std::size_t at = 0; at < looked_at; at += 2) {
    const auto low = static_cast<unsigned char>(bytes[at]);
    const bool is_text = (low >= 0x20 && low < 0x7F) || low == '\n' || low == '\r' || low == '\t';
    if (!is_text || bytes[at + 1] != 0) return false;
  }
  return true;
}

class Decoder {
 public:
  DecodedText take() { return std::move(result_); }

  void utf8(std::string bytes) {
    if (plain(bytes)) {
      result_.text = std::move(bytes);
      return;
    }
    result_.text.reserve(bytes.size() + bytes.size() / 16);
    const std::string_view rest = bytes;
    for (std::size_t at = 0; at < rest.size();) {
      const CodePoint point = read_utf8(rest.substr(at));
      if (point.size == 0) {
        put_single_byte(static_cast<unsigned char>(rest[at]));
        ++at;
        continue;
      }
      at += point.size;
      const bool line_end = point.value == '\r' && (at == rest.size() || rest[at] == '\n');
      put(point.value, line_end);
    }
  }

  void utf16(std::string_view bytes, bool big_endian) {
    std::string text;
    text.reserve(bytes.size() / 2);
    const auto unit_at = [&](std::size_t at) -> char32_t {
      const auto first = static_cast<unsigned char>(bytes[at]);
      const auto second = static_cast<unsigned char>(bytes[at + 1]);
      return big_endian ? first << 8U | second : second << 8U | first;
    };
    std::size_t at = 0;
    for (; at + 1 < bytes.size(); at += 2) {
      char32_t value = unit_at(at);
      if (value >= 0xD800 && value < 0xE000) {
        const char32_t low = value < 0xDC00 && at + 3 < bytes.size() ? unit_at(at + 2) : 0;
        const bool pair = low >= 0xDC00 && low < 0xE000;
        value = pair ? 0x10000 + ((value - 0xD800) << 10U) + (low - 0xDC00) : replacement;
        at += pair ? 2 : 0;
      }
      append_utf8(text, value);
    }
    if (at < bytes.size()) {
      append_utf8(text, replacement);
    }
    utf8(std::move(text));
  }

 private:
  /// Only printable ASCII, tabs and line ends: by far the most common deck.
  static bool plain(std::string_view bytes) {
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const auto c = static_cast<unsigned char>(bytes[i]);
      if (c >= 0x7F || (c < 0x20 && c != '\n' && c != '\t' && (c != '\r' || (i + 1 < bytes.size() && bytes[i + 1] != '\n')))) {
        return false;
      }
    }
    return true;
  }

  void put_single_byte(unsigned char byte) {
    const char32_t value = byte >= 0xA0 ? byte : windows_1252[byte - 0x80U];
    const std::size_t offset = result_.text.size();
    put(value == 0 ? replacement : value, true);
    if (value == 0) {
      add_problem(TextProblem::Kind::encoding, offset);
    }
  }

  void put(char32_t c, bool allowed) {
    const std::size_t offset = result_.text.size();
    append_utf8(result_.text, c == no_break_space ? U' ' : c);
    const bool control = (c < 0x20 && c != '\t' && c != '\n') || (c >= 0x7F && c < 0xA0);
    if (c == 0) {
      add_problem(TextProblem::Kind::null, offset);
    } else if (control && !allowed) {
      add_problem(TextProblem::Kind::control, offset);
    }
  }

  void add_problem(TextProblem::Kind kind, std::size_t offset) {
    constexpr std::size_t most_problems = 1000;
    const bool first_null = kind == TextProblem::Kind::null && !seen_null_;
    seen_null_ = seen_null_ || first_null;
    if (result_.problems.size() < most_problems || first_null) {
      result_.problems.push_back({kind, static_cast<std::uint32_t>(offset), static_cast<std::uint32_t>(result_.text.size() - offset)});
    }
  }

  DecodedText result_;
  bool seen_null_ = false;
};

}  // namespace

DecodedText decode(std::string bytes) {
  Decoder decoder;
  if (bytes.starts_with("\xFF\xFE")) {
    decoder.utf16(std::string_view(bytes).substr(2), false);
  } else if (bytes.starts_with("\xFE\xFF")) {
    decoder.utf16(std::string_view(bytes).substr(2), true);
  } else if (begins_as_utf16(bytes)) {
    decoder.utf16(bytes, false);
  } else {
    if (bytes.starts_with("\xEF\xBB\xBF")) {
      bytes.erase(0, 3);
    }
    decoder.utf8(std::move(bytes));
  }
  return decoder.take();
}

}  // namespace pwlsim::netlist
