#include "waveform/raw_file.hpp"

#include <algorithm>
#include <cstring>

#include "base/names.hpp"

namespace pwlsim::waveform {
namespace {

constexpr std::string_view binary_mark = "Binary:\n";
constexpr std::string_view names_mark = "Variables:\n";

/// "\t1\tv(out)\tvoltage"
std::string name_of(std::string_view line) {
  const std::size_t first = line.find('\t', 1);
  if (first == std::string_view::npos) return {};
  const std::size_t last = line.find('\t', first + 1);
  return without_case(line.substr(first + 1, last == std::string_view::npos ? last : last - first - 1));
}

std::vector<std::string> names_of(std::string_view text) {
  std::vector<std::string> names;
  while (!text.empty() && text[0] == '\t') {
    const std::size_t end = std::min(text.find('\n'), text.size());
    names.push_back(name_of(text.substr(0, end)));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return names;
}

}  // namespace

std::optional<std::size_t> RawFile::find(std::string_view name) const {
  const auto found = std::find(names.begin(), names.end(), without_case(name));
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

std::optional<RawFile> read_raw(std::string_view bytes) {
  const std::size_t mark = bytes.find(binary_mark);
  const std::size_t names = bytes.substr(0, mark).find(names_mark);
  if (mark == std::string_view::npos || names == std::string_view::npos) return std::nullopt;
  RawFile file;
  file.names = names_of(bytes.substr(names + names_mark.size(), mark - names - names_mark.size()));
  if (file.names.empty()) return std::nullopt;
  const std::string_view body = bytes.substr(mark + binary_mark.size());
  const std::size_t row = file.names.size() * sizeof(double);
  file.values.resize(body.size() / row * file.names.size());
  if (!file.values.empty()) std::memcpy(file.values.data(), body.data(), file.values.size() * sizeof(double));
  return file;
}

}  // namespace pwlsim::waveform
