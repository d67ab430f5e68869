#pragma once
/// Texts that were read, and places in them.

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

/// The smallest span that covers both; `a` alone if they are in different files, `b` if `a` is unknown.
[[nodiscard]] SourceSpan cover(const SourceSpan& a, const SourceSpan& b);

/// 1-based line and column; the column counts code points, as editors do.
struct SourcePosition {
  std::uint32_t line = 0;
  std::uint32_t column = 0;
};

/// Where a line comes from that the program wrote itself: for a line of a schematic's netlist, the line of the schematic.
struct SourceOrigin {
  FileIndex file = no_file;  ///< no_file: it has no origin
  std::uint32_t offset = 0;  ///< the offset in that file
  bool is_verbatim = false;  ///< the file contains the line unchanged, so that places within it are known, too
};

/// A place as messages name it.
struct SourcePlace {
  std::string_view name;  ///< of the file
  SourcePosition position;
};

/// Owns every text read (UTF-8) with its line map. Texts are never removed or moved, so spans and views stay valid.
class SourceStore {
 public:
  /// `name` is printed in messages as given.
  FileIndex add(std::string name, std::string text);
  /// A text that the program wrote, with the origin of each of its lines.
  FileIndex add(std::string name, std::string text, std::vector<SourceOrigin> origins);

  [[nodiscard]] const std::string& name(FileIndex file) const { return files_.at(file).name; }
  [[nodiscard]] std::string_view text(FileIndex file) const { return files_.at(file).text; }
  [[nodiscard]] std::string_view text(const SourceSpan& span) const;
  [[nodiscard]] SourcePosition position(FileIndex file, std::uint32_t offset) const;
  /// The same for the user: if the program wrote the line, in the file that it comes from.
  [[nodiscard]] SourcePlace place(FileIndex file, std::uint32_t offset) const;
  /// A line of a text that the program wrote, without an origin.
  [[nodiscard]] bool is_from_nowhere(FileIndex file, std::uint32_t offset) const;
  /// The whole line that holds `offset`, without its line end.
  [[nodiscard]] std::string_view line_at(FileIndex file, std::uint32_t offset) const;

 private:
  struct File {
    std::string name;
    std::string text;
    std::vector<std::uint32_t> line_starts;
    std::vector<SourceOrigin> origins;  ///< of the lines; empty if the text was read
  };
  /// Null if the text was read.
  [[nodiscard]] const SourceOrigin* origin(FileIndex file, std::uint32_t line) const;
  std::deque<File> files_;  // keeps every text where it is while others are added
};

}  // namespace pwlsim
