#include "random_decks/deck_mistakes.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>

namespace pwlsim::test {
namespace {

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::string joined(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + word;
  return line;
}

bool holds_times(const std::string& line) {
  const char first = line.empty() ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(line.front())));
  return first == 'v' || first == 'i' || first == 'b' || line.starts_with(".tran") || line.starts_with(".param");
}

std::size_t any_place(const std::string& text, Random& random) {
  return static_cast<std::size_t>(random.whole(0, static_cast<int>(text.size()) - 1));
}

void alter_word(std::vector<std::string>& words, bool with_times, Random& random) {
  static const std::vector<std::string> numbers{"0",   "-1",   "1e99", "-1e-99", "1e-15", "1e400",
                                                "inf", "-inf", "1k5",  "{1/0}",  "{p1*}", "1e3e3"};
  static const std::vector<std::string> harmless{"0",     "-1", "inf", "abc", "1..2", "{x", "--5", "1e",
                                                 "{nix}", "()", "[",   "\"",  "=",    "V(", ",",   "'"};
  const auto at = static_cast<std::size_t>(random.whole(0, static_cast<int>(words.size()) - 1));
  switch (random.whole(0, with_times ? 3 : 5)) {
    case 0:
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(at));
      break;
    case 1:
      words.insert(words.begin() + static_cast<std::ptrdiff_t>(at), words[at]);
      break;
    case 2:
      words[at] = random.one_of(harmless);
      break;
    case 3:
      std::swap(words[at], words.back());
      break;
    default:
      words[at] = random.one_of(numbers);
  }
}

void alter_letter(std::string& line, Random& random) {
  static constexpr std::string_view letters = "abcdefilmnopqrstuvxyz(){}[]=,.;:+-*/^\"'$%&|<>?!#@~\\ \t";
  const std::size_t at = any_place(line, random);
  switch (random.whole(0, 3)) {
    case 0:
      if (std::isdigit(static_cast<unsigned char>(line[at])) == 0 && line[at] != '.') line.erase(at, 1);
      break;
    case 1:
      line.insert(at, 1, random.one_of(letters));
      break;
    case 2:
      line[at] = random.one_of(letters);
      break;
    default:
      line.resize(at);
  }
}

}  // namespace

void make_mistake(std::vector<std::string>& lines, Random& random) {
  if (lines.size() < 2) return;
  const auto at = static_cast<std::size_t>(random.whole(1, static_cast<int>(lines.size()) - 1));
  std::string& line = lines[at];
  if (line.empty()) return;
  const bool with_times = holds_times(line);
  const double kind = random.unit();
  if (kind < 0.15) {
    lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(at));
  } else if (kind < 0.25) {
    lines.insert(lines.begin() + random.whole(1, static_cast<int>(lines.size()) - 1), std::string(line));
  } else if (kind < 0.75 || with_times) {
    std::vector<std::string> words = words_of(line);
    if (!words.empty()) alter_word(words, with_times, random);
    line = joined(words);
  } else {
    alter_letter(line, random);
  }
}

void write_otherwise(std::vector<std::string>& lines, Random& random) {
  for (std::size_t i = 1; i < lines.size(); ++i) {
    std::string& line = lines[i];
    if (random.chance(0.02))
      std::transform(line.begin(), line.end(), line.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    if (random.chance(0.03)) line += random.one_of(std::array{" ; comment", " $ comment", " // comment", "   ", "\t"});
    const std::size_t blank = line.find(' ', 4);
    if (random.chance(0.04) && blank != std::string::npos && blank + 1 < line.size()) line.replace(blank, 1, "\n+ ");
    if (random.chance(0.02)) line += "\r";
  }
}

}  // namespace pwlsim::test
