#include "waveform/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>

#include "waveform/output_file.hpp"

namespace pwlsim::waveform {
namespace {

constexpr std::size_t longest_double = 24;  // "-2.2250738585072014e-308"
constexpr std::size_t buffer_size = std::size_t{1} << 18;

std::string header_line(std::span<const std::string> names) {
  std::string line;
  for (const std::string& name : names) {
    if (!line.empty()) line += ',';
    line += csv_field(name);
  }
  line += '\n';
  return line;
}

}  // namespace

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string field = "\"";
  for (const char character : text) {
    if (character == '"') field += '"';
    field += character;
  }
  return field + '"';
}

void append_csv_row(std::string& text, std::string_view prefix, std::span<const double> values) {
  text += prefix;
  char number[longest_double];
  for (const double value : values) {
    text.append(number, std::to_chars(number, number + longest_double, value).ptr);
    text += ',';
  }
  text.back() = '\n';
}

std::string shortest(double value) {
  char text[longest_double];
  return {text, std::to_chars(text, text + longest_double, value).ptr};
}

std::string rounded(double value, int digits) { return digits == 0 ? shortest(value) : fmt::format("{:.{}g}", value, digits); }

CsvWriter::CsvWriter(OutputFile& file, std::span<const std::string> names)
    : file_(file), columns_(names.size()), row_room_(columns_ * (longest_double + 1)) {
  const std::string header = header_line(names);
  capacity_ = std::max({buffer_size, row_room_, header.size()});
  buffer_ = std::make_unique_for_overwrite<char[]>(capacity_);
  used_ = header.copy(buffer_.get(), header.size());
}

bool CsvWriter::write(std::span<const double> values) {
  assert(values.size() % columns_ == 0);
  const double* value = values.data();
  const double* const end = value + values.size();
  while (value != end) {
    if (capacity_ - used_ < row_room_ && !flush()) return false;
    char* out = buffer_.get() + used_;
    for (std::size_t column = 0; column < columns_; ++column) {
      out = std::to_chars(out, out + longest_double, *value++).ptr;
      *out++ = ',';
    }
    out[-1] = '\n';
    used_ = static_cast<std::size_t>(out - buffer_.get());
  }
  return !file_.failed();
}

bool CsvWriter::flush() {
  const bool written = file_.write({buffer_.get(), used_});
  used_ = 0;
  return written;
}

}  // namespace pwlsim::waveform
