#include "regression/reference.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace pwlsim::test {
namespace {

/// The fields of one line; a field in quotes may hold commas.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char character : line) {
    if (character == '"') {
      quoted = !quoted;
    } else if (character == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += character;
    }
  }
  return fields;
}

/// Head and rows of a file, lines that start with # left out.
std::vector<std::vector<std::string>> read_table(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("no reference " + path.string());
  std::vector<std::vector<std::string>> table;
  for (std::string line; std::getline(file, line);)
    if (!line.empty() && line.front() != '#') table.push_back(fields_of(line));
  if (table.empty()) throw std::runtime_error("empty reference " + path.string());
  for (const auto& row : table)
    if (row.size() != table.front().size()) throw std::runtime_error("ragged reference " + path.string());
  return table;
}

double number(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0') throw std::runtime_error("'" + text + "' is no number");
  return value;
}

}  // namespace

double Reference::maximum(std::size_t signal) const {
  double largest = 0.0;
  for (const auto& row : rows) largest = std::max(largest, std::abs(row[signal + 1]));
  for (const auto& event : events) largest = std::max(largest, std::abs(event.after[signal]));
  return largest > 0.0 ? largest : 1.0;
}

std::filesystem::path reference_folder() { return std::filesystem::path(PWLSIM_SOURCE_DIR) / "tests" / "reference"; }

Reference read_rows(const std::filesystem::path& path) {
  Reference reference;
  const auto table = read_table(path);
  reference.signals.assign(table.front().begin() + 1, table.front().end());
  for (std::size_t i = 1; i < table.size(); ++i) {
    reference.rows.emplace_back();
    for (const auto& field : table[i]) reference.rows.back().push_back(number(field));
  }
  return reference;
}

Reference read_reference(const std::string& name) {
  Reference reference = read_rows(reference_folder() / (name + ".csv"));
  const auto events = read_table(reference_folder() / (name + ".events.csv"));
  if (events.front().size() != reference.signals.size() + 2)
    throw std::runtime_error("events of " + name + " have other signals than its rows");
  for (std::size_t i = 1; i < events.size(); ++i) {
    ReferenceEvent event{number(events[i][0]), events[i][1], {}};
    for (std::size_t column = 2; column < events[i].size(); ++column) event.after.push_back(number(events[i][column]));
    reference.events.push_back(std::move(event));
  }
  return reference;
}

}  // namespace pwlsim::test
