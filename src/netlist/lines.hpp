#pragma once
/// Physical lines -> logical lines: comments removed, continuations joined; the place of every byte in the source is kept.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/source.hpp"

namespace pwlsim::netlist {

/// One card's text on one line. Refers to the source text it was read from.
class LogicalLine {
 public:
  LogicalLine() = default;
  LogicalLine(const LogicalLine&) = delete;  // text() may point into the object
  LogicalLine& operator=(const LogicalLine&) = delete;

  [[nodiscard]] std::string_view text() const { return view_; }
  [[nodiscard]] const char* begin() const { return view_.data(); }
  [[nodiscard]] const char* end() const { return view_.data() + view_.size(); }

  /// The span of [first, last), a part of text(), in the source.
  [[nodiscard]] SourceSpan span(const char* first, const char* last) const;
  [[nodiscard]] SourceSpan span(std::string_view part) const { return span(part.data(), part.data() + part.size()); }

  /// The line begins with `+` but has no card before it; text() is the text after the `+`.
  [[nodiscard]] bool orphan() const { return orphan_; }

 private:
  friend class LineReader;
  struct Piece {
    std::uint32_t at;      ///< offset in text()
    std::uint32_t source;  ///< offset in the source
  };

  void start(FileIndex file, std::string_view piece, std::uint32_t source, bool orphan);
  void join(std::string_view piece, std::uint32_t source);
  [[nodiscard]] std::uint32_t source_offset(const char* at) const;

  FileIndex file_ = no_file;
  std::string_view view_;
  std::string joined_;  ///< the text if it has more than one piece
  std::vector<Piece> pieces_;
  bool orphan_ = false;
};

/// Returns the logical lines of `text` one by one. Cheap to copy, for looking ahead.
class LineReader {
 public:
  LineReader(FileIndex file, std::string_view text, std::size_t begin = 0) : file_(file), text_(text), at_(begin) {}

  /// The next line that is not a comment; false at the end of the text.
  bool next(LogicalLine& line);

 private:
  struct Physical {
    std::string_view content;  ///< without the comment and outer blanks
    bool continues = false;    ///< it began with `+`, which is removed
  };
  /// The next physical line with more than blanks and comments, and where the line after it begins.
  bool next_physical(Physical& line, std::size_t& after) const;

  FileIndex file_;
  std::string_view text_;
  std::size_t at_;
};

/// `line` up to its end-of-line comment: `;`, `//`, or a `$` between blanks, outside "…".
[[nodiscard]] std::string_view without_comment(std::string_view line);

/// Blanks are spaces, tabs and all lower characters; control characters were reported when the text was read.
[[nodiscard]] constexpr bool is_blank(char c) { return static_cast<unsigned char>(c) <= ' '; }
[[nodiscard]] std::string_view trimmed(std::string_view text);

}  // namespace pwlsim::netlist
