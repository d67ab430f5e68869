#include "netlist/lines.hpp"

#include <algorithm>
#include <array>

namespace pwlsim::netlist {

namespace {

bool blank_or_outside(std::string_view text, std::size_t at) { return at >= text.size() || is_blank(text[at]); }

/// Whether an end-of-line comment begins at `at`, which holds one of `; / $`.
bool comment_begins(std::string_view line, std::size_t at) {
  switch (line[at]) {
    case ';':
      return true;
    case '/':
      return at + 1 < line.size() && line[at + 1] == '/';
    default:
      return (at == 0 || is_blank(line[at - 1])) && blank_or_outside(line, at + 1);
  }
}

constexpr std::array<bool, 256> comment_or_quote = [] {
  std::array<bool, 256> table{};
  for (const char c : {';', '/', '$', '"'}) {
    table[static_cast<unsigned char>(c)] = true;
  }
  return table;
}();

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) {
    text.remove_prefix(1);
  }
  while (!text.empty() && is_blank(text.back())) {
    text.remove_suffix(1);
  }
  return text;
}

std::string_view without_comment(std::string_view line) {
  bool quoted = false;
  for (std::size_t at = 0; at < line.size(); ++at) {
    if (!comment_or_quote[static_cast<unsigned char>(line[at])]) {
      continue;
    }
    if (line[at] == '"') {
      quoted = !quoted;
    } else if (!quoted && comment_begins(line, at)) {
      return line.substr(0, at);
    }
  }
  return line;
}

void LogicalLine::start(FileIndex file, std::string_view piece, std::uint32_t source, bool orphan) {
  file_ = file;
  view_ = piece;
  pieces_.assign(1, {0, source});
  orphan_ = orphan;
}

void LogicalLine::join(std::string_view piece, std::uint32_t source) {
  if (pieces_.size() == 1) {
    joined_.assign(view_);
  }
  joined_.push_back(' ');
  pieces_.push_back({static_cast<std::uint32_t>(joined_.size()), source});
  joined_.append(piece);
  view_ = joined_;
}

std::uint32_t LogicalLine::source_offset(const char* at) const {
  const auto offset = static_cast<std::uint32_t>(at - view_.data());
  if (pieces_.size() == 1) {
    return pieces_.front().source + offset;
  }
  const auto after = std::upper_bound(pieces_.begin(), pieces_.end(), offset, [](std::uint32_t o, const Piece& p) { return o < p.at; });
  const Piece& piece = *(after - 1);
  return piece.source + (offset - piece.at);
}

SourceSpan LogicalLine::span(const char* first, const char* last) const {
  const std::uint32_t begin = source_offset(first);
  // The end is taken from the last byte: one further on may already stand on another line.
  return {file_, begin, first == last ? begin : source_offset(last - 1) + 1};
}

bool LineReader::next_physical(Physical& line, std::size_t& after) const {
  for (std::size_t at = after; at < text_.size(); at = after) {
    const std::size_t line_end = std::min(text_.find('\n', at), text_.size());
    after = std::min(line_end + 1, text_.size());
    std::string_view content = trimmed(text_.substr(at, line_end - at));
    if (content.empty() || content.front() == '*') {
      continue;
    }
    line.continues = content.front() == '+';
    content = trimmed(without_comment(content));
    if (line.continues && !content.empty()) {
      content = trimmed(content.substr(1));
    }
    if (!content.empty()) {
      line.content = content;
      return true;
    }
  }
  return false;
}

bool LineReader::next(LogicalLine& line) {
  Physical physical;
  if (!next_physical(physical, at_)) {
    return false;
  }
  const auto source_of = [&](const Physical& p) { return static_cast<std::uint32_t>(p.content.data() - text_.data()); };
  line.start(file_, physical.content, source_of(physical), physical.continues);
  for (std::size_t after = at_; next_physical(physical, after) && physical.continues; at_ = after) {
    line.join(physical.content, source_of(physical));
  }
  return true;
}

}  // namespace pwlsim::netlist
