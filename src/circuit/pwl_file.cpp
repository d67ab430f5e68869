#include "circuit/pwl_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "base/names.hpp"

namespace pwlsim::circuit {
namespace {

namespace fs = std::filesystem;
using elements::PwlPoint;
using netlist::Item;

std::optional<std::ifstream> opened(const std::string& name, const fs::path& folder) {
  for (const fs::path& path : {folder / name, fs::path(name)}) {
    std::error_code unknown;
    if (!fs::is_regular_file(path, unknown)) continue;
    if (std::ifstream file(path); file) return file;
  }
  return std::nullopt;
}

/// A number as a deck spells it.
std::optional<double> number(const std::string& text, const Item& item, Scope& scope) {
  Item word = item;
  word.kind = Item::Kind::word;
  word.text = text;
  word.items.clear();
  const std::optional<Number> found = scope.number(word);
  return found ? std::optional(found->value) : std::nullopt;
}

/// Comments and empty lines have no pair.
bool has_pair(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  return first != std::string::npos && std::string_view("*;#").find(line[first]) == std::string_view::npos;
}

std::optional<PwlPoint> point_of(std::string line, const Item& item, Scope& scope) {
  for (char& c : line)
    if (c == ',' || c == ';' || c == '\t' || c == '\r') c = ' ';
  std::istringstream words(line);
  std::string time, value, rest;
  if (!(words >> time >> value) || (words >> rest)) return std::nullopt;
  PwlPoint point;
  point.span = item.span;
  point.relative = time.front() == '+';
  const auto at = number(point.relative ? time.substr(1) : time, item, scope), level = number(value, item, scope);
  if (!at || !level) return std::nullopt;
  point.time = *at;
  point.value = *level;
  return point;
}

}  // namespace

bool is_pwl_file(const Item& item) { return item.kind == Item::Kind::assignment && same_name(item.text, "file"); }

bool read_pwl_file(const Item& item, elements::PwlCard& card, Scope& scope, Reporter& reporter) {
  const auto fail = [&](const std::string& text) {
    reporter.error("E-pwl-file", item.span, text);
    return false;
  };
  if (item.items.empty()) return fail("file= has no name; try PWL file=points.txt");
  const std::string& name = item.items[0].text;
  std::optional<std::ifstream> file = opened(name, fs::path(reporter.file_of(item.span)).parent_path());
  if (!file) return fail(fmt::format("cannot read '{}': no such file beside the deck, nor in the current directory; try its path", name));
  elements::PwlPart part{{}, 1.0, item.span};
  std::size_t count = 0;
  for (std::string line; std::getline(*file, line);) {
    ++count;
    if (!has_pair(line)) continue;
    const std::optional<PwlPoint> point = point_of(line, item, scope);
    if (!point) return fail(fmt::format("line {} of '{}' is not a pair of a time and a value; try two numbers per line", count, name));
    part.points.push_back(*point);
  }
  card.parts.push_back(std::move(part));
  return true;
}

}  // namespace pwlsim::circuit
