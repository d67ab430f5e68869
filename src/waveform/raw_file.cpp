#include "waveform/raw_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "base/names.hpp"
#include "waveform/output_file.hpp"

namespace pwlsim::waveform {
namespace {

constexpr std::string_view binary_mark = "\nBinary:\n";
constexpr std::string_view names_mark = "\nVariables:\n";

constexpr std::string_view points_mark = "No. Points: ";
/// ngspice takes it as the version of the program that wrote the file; readers of LTspice files look for a known program in it.
constexpr std::string_view command = "Command: version pwlsim, read as ngspice";
/// Room for any number of points.
constexpr int points_width = 20;

/// A title is one line of text.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  return text;
}

/// Names end at a blank.
std::string one_word(std::string text) {
  text.erase(std::remove_if(text.begin(), text.end(), [](unsigned char c) { return c <= ' '; }), text.end());
  return text;
}

std::string head_of(const std::string& title, std::span<const RawVector> vectors, bool stepped) {
  std::string head = fmt::format(
      "Title: {}\nDate: Thu Jan  1 00:00:00  1970\nPlotname: Transient Analysis\nFlags: real{}\nNo. Variables: {}\n{}{:<{}}\n{}{}",
      one_line(title), stepped ? " stepped" : "", vectors.size(), points_mark, 0, points_width, command, names_mark);
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < vectors.size(); ++k)
    lines.push_back(fmt::format("\t{}\t{}\t{}", k, one_word(vectors[k].name), vectors[k].type));
  return head += fmt::format("{}{}", fmt::join(lines, "\n"), binary_mark);
}

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

RawWriter::RawWriter(OutputFile& file, const std::string& title, std::span<const RawVector> vectors, bool stepped)
    : file_(file), row_bytes_(vectors.size() * sizeof(double)) {
  const std::string head = head_of(title, vectors, stepped);
  head_bytes_ = head.size();
  count_at_ = head.find(fmt::format("\n{}", points_mark)) + 1 + points_mark.size();
  if (file_.hold()) file_.write(head);
}

bool RawWriter::write(std::span<const double> values) {
  return file_.write({reinterpret_cast<const char*>(values.data()), values.size_bytes()}, row_bytes_);
}

bool RawWriter::flush() {
  if (file_.size() < head_bytes_) return false;
  const std::uint64_t points = (file_.size() - head_bytes_) / row_bytes_;
  return file_.overwrite(count_at_, fmt::format("{:<{}}", points, points_width)) && !file_.failed();
}

}  // namespace pwlsim::waveform
