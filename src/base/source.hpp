#pragma once
/// Texts the user gave us and places in them.

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace pwlsim {

using FileIndex = std::uint32_t;
inline constexpr FileIndex no_file = ~FileIndex{0};

/// Half-open byte range [begin, end) of one text of a SourceStore.
struct SourceSpan {
  FileIndex file = no_file;
  std::uint32_t begin = 0;
  std::uint32_t end = 0;

  [[nodiscard]] bool known() const { return file != no_file; }
  friend bool operator==(const SourceSpan&, const SourceSpan&) = default;
};

/// The smallest span that covers both; `a` alone when they stand in different files, `b` where `a` is unknown.
[[nodiscard]] SourceSpan cover(const SourceSpan& a, const SourceSpan& b);

/// 1-based line and column; the column counts code points, as editors do.
struct SourcePosition {
  std::uint32_t line = 0;
  std::uint32_t column = 0;
};

/// Owns every text read (UTF-8) with its line map. Texts are never dropped nor moved, so spans and views stay valid.
class SourceStore {
 public:
  /// `name` is printed in messages as given.
  FileIndex add(std::string name, std::string text);

  [[nodiscard]] const std::string& name(FileIndex file) const { return files_.at(file).name; }
  [[nodiscard]] std::string_view text(FileIndex file) const { return files_.at(file).text; }
  [[nodiscard]] std::string_view text(const SourceSpan& span) const;
  [[nodiscard]] SourcePosition position(FileIndex file, std::uint32_t offset) const;
  /// The whole line that holds `offset`, without its line end.
  [[nodiscard]] std::string_view line_at(FileIndex file, std::uint32_t offset) const;

 private:
  struct File {
    std::string name;
    std::string text;
    std::vector<std::uint32_t> line_starts;
  };
  std::deque<File> files_;  // keeps every text where it is while others are added
};

}  // namespace pwlsim
