#include "table.hpp"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace pwlsim::mpi {
namespace {

constexpr const char* whole = ".";

std::string line_of(const Record& record) {
  std::string line = std::to_string(record.number) + " " + (record.id.empty() ? "-" : record.id);
  char text[40];
  for (const double value : record.measurements) {
    std::snprintf(text, sizeof text, " %a", value);
    line += text;
  }
  return line + " " + whole + "\n";
}

/// Empty where the line was cut off.
std::optional<Record> record_in(const std::string& line) {
  std::istringstream words(line);
  Record record;
  std::string word, before;
  if (!(words >> record.number >> record.id)) return {};
  if (record.id == "-") record.id.clear();
  while (words >> word) {
    if (word == whole) return record;
    record.measurements.push_back(std::strtod(word.c_str(), nullptr));
  }
  return {};
}

}  // namespace

Journal::Journal(std::string path, const std::string& head, bool resume, std::vector<std::optional<Record>>& records)
    : path_(std::move(path)) {
  std::string kept = head + "\n";
  std::ifstream old(path_);
  if (std::string line; resume && std::getline(old, line)) {
    if (line != head) throw std::runtime_error(path_ + " is of other runs; try without --resume");
    while (std::getline(old, line))
      if (const auto record = record_in(line); record && record->number < records.size()) records[record->number] = record;
  }
  for (const auto& record : records)
    if (record) kept += line_of(*record);
  // Whole lines only, and the file is never without them.
  const std::string fresh = path_ + ".new";
  file_ = std::fopen(fresh.c_str(), "w");
  if (file_ == nullptr || std::fputs(kept.c_str(), file_) < 0 || std::fflush(file_) != 0) throw std::runtime_error("cannot write " + fresh);
  std::filesystem::rename(fresh, path_);
}

Journal::~Journal() {
  if (file_ != nullptr) std::fclose(file_);
}

void Journal::add(const Record& record) {
  if (std::fputs(line_of(record).c_str(), file_) < 0 || std::fflush(file_) != 0) throw std::runtime_error("cannot write " + path_);
}

void Journal::remove() { std::filesystem::remove(path_); }

std::string number_text(double value) {
  if (std::isnan(value)) return "";
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

}  // namespace pwlsim::mpi
