#include "base/source.hpp"

#include <algorithm>
#include <cstring>

namespace pwlsim {

SourceSpan cover(const SourceSpan& a, const SourceSpan& b) {
  if (!a.known()) {
    return b;
  }
  if (a.file != b.file) {
    return a;
  }
  return {a.file, std::min(a.begin, b.begin), std::max(a.end, b.end)};
}

FileIndex SourceStore::add(std::string name, std::string text) { return add(std::move(name), std::move(text), {}); }

FileIndex SourceStore::add(std::string name, std::string text, std::vector<SourceOrigin> origins) {
  File file{std::move(name), std::move(text), {0}, std::move(origins)};
  const char* const begin = file.text.data();
  const char* const end = begin + file.text.size();
  for (const char* at = begin; at != end; ++at) {
    at = static_cast<const char*>(std::memchr(at, '\n', static_cast<std::size_t>(end - at)));
    if (at == nullptr) {
      break;
    }
    file.line_starts.push_back(static_cast<std::uint32_t>(at - begin + 1));
  }
  files_.push_back(std::move(file));
  return static_cast<FileIndex>(files_.size() - 1);
}

std::string_view SourceStore::text(const SourceSpan& span) const {
  if (!span.known()) {
    return {};
  }
  const std::string_view whole = text(span.file);
  const std::size_t begin = std::min<std::size_t>(span.begin, whole.size());
  const std::size_t end = std::clamp<std::size_t>(span.end, begin, whole.size());
  return whole.substr(begin, end - begin);
}

SourcePosition SourceStore::position(FileIndex file, std::uint32_t offset) const {
  const auto& starts = files_.at(file).line_starts;
  const auto line = std::upper_bound(starts.begin(), starts.end(), offset) - starts.begin();
  const std::uint32_t start = starts[static_cast<std::size_t>(line - 1)];
  const std::string_view before = text(SourceSpan{file, start, offset});
  const auto code_points = std::count_if(before.begin(), before.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;  // all but UTF-8 continuation bytes
  });
  return {static_cast<std::uint32_t>(line), static_cast<std::uint32_t>(code_points + 1)};
}

const SourceOrigin* SourceStore::origin(FileIndex file, std::uint32_t line) const {
  const auto& origins = files_.at(file).origins;
  return line <= origins.size() ? &origins[line - 1] : nullptr;
}

SourcePlace SourceStore::place(FileIndex file, std::uint32_t offset) const {
  const SourcePosition here = position(file, offset);
  const SourceOrigin* const from = origin(file, here.line);
  if (from == nullptr || from->file == no_file) {
    return {name(file), here};
  }
  SourcePosition there = position(from->file, from->offset);
  if (from->is_verbatim) {
    there.column += here.column - 1;
  }
  return {name(from->file), there};
}

bool SourceStore::is_from_nowhere(FileIndex file, std::uint32_t offset) const {
  const SourceOrigin* const from = origin(file, position(file, offset).line);
  return from != nullptr && from->file == no_file;
}

std::string_view SourceStore::line_at(FileIndex file, std::uint32_t offset) const {
  const auto& starts = files_.at(file).line_starts;
  const std::string_view whole = text(file);
  const auto next = std::upper_bound(starts.begin(), starts.end(), offset);
  std::string_view line = whole.substr(*(next - 1), (next == starts.end() ? whole.size() : *next) - *(next - 1));
  for (const char line_end : {'\n', '\r'}) {
    if (!line.empty() && line.back() == line_end) {
      line.remove_suffix(1);
    }
  }
  return line;
}

}  // namespace pwlsim
