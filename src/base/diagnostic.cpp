#include "base/diagnostic.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace pwlsim {

namespace {

// A line wider than this is shown as a window around the span.
constexpr std::size_t widest_line = 160;
constexpr std::size_t context_before = 60;
constexpr std::size_t longest_text = 1000;
constexpr std::size_t tab_stop = 8;
constexpr std::string_view ellipsis = "…";
constexpr std::string_view unprintable = "\xEF\xBF\xBD";

bool continues_code_point(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

/// Bytes of the code point at `at`; 1 where the bytes are not UTF-8.
std::size_t code_point_size(std::string_view text, std::size_t at) {
  const auto lead = static_cast<unsigned char>(text[at]);
  const std::size_t size = lead < 0xC0 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  if (at + size > text.size()) {
    return 1;
  }
  for (std::size_t i = 1; i < size; ++i) {
    if (!continues_code_point(text[at + i])) {
      return 1;
    }
  }
  return size;
}

/// What a terminal may show for one code point: control characters, stray bytes and direction overrides are replaced.
std::string_view printable(std::string_view code_point) {
  const auto lead = static_cast<unsigned char>(code_point[0]);
  if (code_point.size() == 1) {
    return lead < 0x20 || lead >= 0x7F ? unprintable : code_point;
  }
  const bool c1_control = code_point.size() == 2 && lead == 0xC2 && static_cast<unsigned char>(code_point[1]) < 0xA0;
  constexpr std::array<std::string_view, 9> direction_marks{"\u202A", "\u202B", "\u202C", "\u202D", "\u202E",
                                                            "\u2066", "\u2067", "\u2068", "\u2069"};
  const bool misleading = std::find(direction_marks.begin(), direction_marks.end(), code_point) != direction_marks.end();
  return c1_control || misleading ? unprintable : code_point;
}

std::string printable_text(std::string_view text) {
  std::string result;
  std::size_t count = 0;
  for (std::size_t at = 0; at < text.size();) {
    if (++count > longest_text) {
      return result.append(ellipsis);
    }
    const std::size_t size = code_point_size(text, at);
    result += printable(text.substr(at, size));
    at += size;
  }
  return result;
}

/// Moves `at` by up to `count` code points back, and returns how many were passed.
std::size_t step_back(std::string_view line, std::size_t& at, std::size_t count) {
  std::size_t passed = 0;
  for (; passed < count && at > 0; ++passed) {
    do {
      --at;
    } while (at > 0 && continues_code_point(line[at]));
  }
  return passed;
}

bool wider_than(std::string_view line, std::size_t limit) {
  if (line.size() <= limit) {
    return false;
  }
  std::size_t count = 0;
  for (const char c : line) {
    count += continues_code_point(c) ? 0 : 1;
    if (count > limit) {
      return true;
    }
  }
  return false;
}

/// The source line and the caret line; `begin` and `end` are byte offsets within `line`.
class Excerpt {
 public:
  Excerpt(std::string_view line, std::size_t begin, std::size_t end) : line_(line), begin_(begin), end_(end) {}

  std::string lines() {
    std::size_t at = 0;
    std::size_t left = widest_line;
    if (wider_than(line_, widest_line)) {
      at = begin_;
      step_back(line_, at, context_before);
      if (at != 0) {
        source_ += ellipsis;
        carets_ += ' ';
        column_ = 1;
      }
    }
    for (; at < line_.size() && left != 0; --left) {
      const std::size_t size = code_point_size(line_, at);
      show(at, line_.substr(at, size));
      at += size;
    }
    if (at < line_.size()) {
      source_ += ellipsis;
    }
    if (!marked_) {
      carets_ += '^';
    }
    carets_.erase(carets_.find_last_not_of(" \t") + 1);
    return source_ + '\n' + carets_ + '\n';
  }

 private:
  void show(std::size_t at, std::string_view code_point) {
    const bool tab = code_point[0] == '\t';
    const std::size_t width = tab ? tab_stop - column_ % tab_stop : 1;
    source_ += tab ? code_point : printable(code_point);
    column_ += width;
    const bool first = !marked_ && at + code_point.size() > begin_;
    if (first || (at >= begin_ && at < end_)) {
      carets_ += first ? '^' : '~';
      // Under a tab inside the span the mark fills the tab's width; elsewhere the tab itself keeps both lines aligned.
      const bool more = at + code_point.size() < end_;
      carets_.append(width - 1, more ? '~' : ' ');
      marked_ = true;
    } else {
      carets_ += tab ? '\t' : ' ';
    }
  }

  std::string_view line_;
  std::size_t begin_;
  std::size_t end_;
  std::string source_;
  std::string carets_;
  std::size_t column_ = 0;
  bool marked_ = false;
};

std::string_view severity_word(Severity severity) {
  switch (severity) {
    case Severity::note:
      return "note";
    case Severity::warning:
      return "warning";
    case Severity::error:
      break;
  }
  return "error";
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Edits (insert, delete, replace, swap of neighbours) from `a` to `b`, or limit + 1 where there are more than `limit`.
std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit) {
  const std::size_t gap = a.size() > b.size() ? a.size() - b.size() : b.size() - a.size();
  if (gap > limit) {
    return limit + 1;
  }
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) {
    last[j] = j;
  }
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    std::size_t smallest = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool equal = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (equal ? 0 : 1)});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1])) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
      smallest = std::min(smallest, row[j]);
    }
    if (smallest > limit) {
      return limit + 1;
    }
    before_last.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

}  // namespace

void Diagnostics::error(std::string id, SourceSpan span, std::string text) {
  list_.push_back({Severity::error, std::move(id), span, std::move(text)});
  ++errors_;
}

std::size_t Diagnostics::soften(const std::function<bool(Diagnostic&)>& accepts) {
  std::size_t softened = 0;
  for (Diagnostic& diagnostic : list_) {
    if (diagnostic.severity != Severity::error || !accepts(diagnostic)) continue;
    diagnostic.severity = Severity::warning;
    ++softened;
  }
  errors_ -= softened;
  return softened;
}

void Diagnostics::warning(std::string id, SourceSpan span, std::string text) {
  list_.push_back({Severity::warning, std::move(id), span, std::move(text)});
}

void Diagnostics::note(std::string id, SourceSpan span, std::string text) {
  list_.push_back({Severity::note, std::move(id), span, std::move(text)});
}

std::string render(const Diagnostic& diagnostic, const SourceStore& sources) {
  std::string head(severity_word(diagnostic.severity));
  head += '[' + diagnostic.id + "]: " + printable_text(diagnostic.text) + '\n';
  const SourceSpan& span = diagnostic.span;
  if (!span.known()) {
    return head;
  }
  const SourcePlace place = sources.place(span.file, span.begin);
  const std::string_view line = sources.line_at(span.file, span.begin);
  const auto line_begin = static_cast<std::size_t>(line.data() - sources.text(span.file).data());
  const std::size_t begin = std::min<std::size_t>(span.begin - line_begin, line.size());
  const std::size_t end = std::clamp<std::size_t>(span.end - std::min<std::size_t>(line_begin, span.end), begin, line.size());
  return printable_text(place.name) + ':' + std::to_string(place.position.line) + ':' + std::to_string(place.position.column) + ": " +
         head + Excerpt(line, begin, end).lines();
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates) {
  // Names longer than this are not typed by hand; comparing them would cost their product.
  constexpr std::size_t longest_name = 200;
  if (name.size() > longest_name) {
    return {};
  }
  const std::string* nearest = nullptr;
  std::size_t limit = name.size() / 3;
  for (const auto& candidate : candidates) {
    const std::size_t distance = edit_distance(name, candidate, limit);
    if (distance > limit || (nearest != nullptr && distance == limit)) {
      continue;
    }
    nearest = &candidate;
    limit = distance;
    if (distance == 0) {
      break;
    }
  }
  return nearest == nullptr ? std::string() : *nearest;
}

}  // namespace pwlsim
