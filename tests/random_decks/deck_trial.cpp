#include "random_decks/deck_trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <regex>
#include <sstream>

#include "support/json.hpp"

namespace pwlsim::test {
namespace {

#ifdef PWLSIM_SANITIZED
constexpr double most_seconds = 60.0, most_mebibytes = 4096.0;  // what it adds to both
constexpr double many_events = 500;                             ///< within the time a run has: it goes on
#else
constexpr double most_seconds = 10.0, most_mebibytes = 1024.0;
constexpr double many_events = 2000;
#endif
constexpr const char* stats_file = "stats.json";

std::set<std::string> ids_of_reference() {
  const std::string page = read_file(PWLSIM_SOURCE_DIR "/docs/reference/messages.md");
  static const std::regex row(R"(\n\| `([EWN]-[a-z-]+)` \|)");
  std::set<std::string> ids;
  for (std::sregex_iterator match(page.begin(), page.end(), row); match != std::sregex_iterator(); ++match) ids.insert((*match)[1]);
  return ids;
}

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds shrinking{60};
constexpr std::size_t shortest_text = 10;
constexpr int interrupted = 130;

struct Head {
  std::string id, text;
};

/// Of a line `place: error[id]: text`, or without a place; empty where it is none.
Head head_of(const std::string& line) {
  for (const std::string_view kind : {"error[", "warning[", "note["}) {
    const std::size_t begin = line.find(kind);
    const std::size_t end = line.find("]: ", begin);
    const bool at_head = begin == 0 || (begin != std::string::npos && begin > 1 && line.compare(begin - 2, 2, ": ") == 0);
    if (!at_head || end == std::string::npos) continue;
    return {line.substr(begin + kind.size(), end - begin - kind.size()), line.substr(end + 3)};
  }
  return {};
}

std::string fault_of_json(const std::string& text) {
  try {
    (void)read_json(text);
  } catch (const std::exception& problem) {
    return std::string("no JSON: ") + problem.what();
  }
  return "";
}

/// Fields of a line; commas within quotes do not count.
std::size_t fields_of(const std::string& line) {
  std::size_t count = 1;
  bool quoted = false;
  for (const char c : line) {
    quoted = quoted != (c == '"');
    if (c == ',' && !quoted) ++count;
  }
  return count;
}

std::string fault_of_row(const std::string& line) {
  std::istringstream fields(line);
  for (std::string field; std::getline(fields, field, ',');) {
    char* end = nullptr;
    if (!std::isfinite(std::strtod(field.c_str(), &end)) || field.empty() || *end != '\0') return "no finite number in the rows: " + line;
  }
  return "";
}

std::string fault_of_rows(const std::string& text) {
  if (text.empty() || text.back() != '\n') return "rows without an end: " + text.substr(0, 200);
  std::istringstream lines(text);
  std::string header;
  std::getline(lines, header);
  const std::size_t columns = fields_of(header);
  for (std::string line; std::getline(lines, line);) {
    if (fields_of(line) != columns) return "a row of another length: " + line;
    if (std::string fault = fault_of_row(line); !fault.empty()) return fault;
  }
  return "";
}

bool names(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

Examiner::Examiner(TrialRunner& runner) : runner_(runner), known_ids_(ids_of_reference()) {}

void Examiner::tidy() const {
  for (const std::string& name : folder_.names()) std::filesystem::remove(folder_.path() / name);
}

void Examiner::run(const RandomDeck& deck, const std::string& name) {
  const std::string file = name + ".net";
  folder_.write(file, deck.text());
  for (const auto& [other, text] : deck.files) folder_.write(other, text);
  std::vector<std::string> arguments = deck.before;
  arguments.push_back(file);
  arguments.insert(arguments.end(), deck.after.begin(), deck.after.end());
  if (deck.before.empty() && !names(deck.after, "--stats")) arguments.insert(arguments.end(), {"--stats", stats_file});
  last_ = runner_.run(folder_, arguments);
}

void Examiner::note_messages(const std::string& name) {
  std::istringstream lines(last_.err);
  for (std::string line; std::getline(lines, line);)
    if (const Head head = head_of(line); !head.id.empty()) first_with_.try_emplace(head.id, name);
}

std::string Examiner::examine(const RandomDeck& deck, const std::string& name) {
  run(deck, name);
  note_messages(name);
  const bool is_long = last_.status == interrupted || last_.seconds > most_seconds;
  if (is_long && had_many_events()) {
    long_runs_.push_back(name);
    tidy();
    return "";
  }
  std::string fault = judge(deck, name);
  tidy();
  return fault;
}

bool Examiner::had_many_events() const {
  return folder_.holds(stats_file) && read_json(read_file(folder_ / stats_file)).object["events"].number >= many_events;
}

std::string Examiner::judge(const RandomDeck& deck, const std::string& name) const {
  const bool file_is_missing = last_.status == 3 && last_.err.find("[E-include-unreadable]") != std::string::npos;
  if ((last_.status < 0 || last_.status > 2) && !file_is_missing)
    return fmt::format("status {}: {}", last_.status, last_.err.substr(0, 2000));
  if (last_.seconds > most_seconds) return fmt::format("too long: {:.1f} s", last_.seconds);
  if (last_.resident_mebibytes > most_mebibytes) return fmt::format("too much memory: {:.0f} MiB", last_.resident_mebibytes);
  if (std::string fault = judge_messages(); !fault.empty()) return fault;
  return judge_files(deck, name);
}

std::string Examiner::judge_messages() const {
  bool error = false;
  std::istringstream lines(last_.err);
  for (std::string line; std::getline(lines, line);) {
    const Head head = head_of(line);
    if (head.id.empty()) continue;
    if (known_ids_.count(head.id) == 0) return fmt::format("unknown id {}: {}", head.id, last_.err);
    if (head.id == "E-internal" || head.id == "E-out-of-memory") return fmt::format("{}: {}", head.id, last_.err);
    if (head.text.size() < shortest_text) return fmt::format("no text behind {}: {}", head.id, last_.err);
    error = error || head.id.front() == 'E';
  }
  if (last_.status != 0 && !error) return fmt::format("no message with status {}: {}", last_.status, last_.err);
  if (last_.status == 0 && error) return "an error with status 0: " + last_.err;
  return "";
}

std::string Examiner::judge_files(const RandomDeck& deck, const std::string& name) const {
  for (const std::string& file : folder_.names()) {
    if (file == name + ".net" || deck.files.count(file) != 0) continue;
    if (last_.status > 1) return "a file of a deck that is wrong: " + file;
    if (file.find(".partial") != std::string::npos) return "a file half written: " + file;
    const std::string text = read_file(folder_.path() / file);
    std::string fault;
    if (file.ends_with(".csv")) fault = fault_of_rows(text);
    if (file.ends_with(".json")) fault = fault_of_json(text);
    if (text.empty()) fault = "an empty file: " + file;
    if (!fault.empty()) return fault;
  }
  const bool is_run = deck.before.empty();
  if (names(deck.after, "--json") && (is_run || last_.status < 2)) return fault_of_json(last_.out);
  if (names(deck.after, "-") && is_run && last_.status < 2 && !last_.out.empty()) return fault_of_rows(last_.out);
  return "";
}

RandomDeck smallest(RandomDeck deck, Examiner& examiner, const std::string& fault) {
  const std::string kind = fault.substr(0, fault.find(':'));
  const Clock::time_point end = Clock::now() + shrinking;
  const auto still_fails = [&](const RandomDeck& tried) {
    const std::string found = examiner.examine(tried, "smaller");
    return found.substr(0, found.find(':')) == kind;
  };
  const auto try_out = [&](RandomDeck tried) {
    const bool fails = Clock::now() < end && still_fails(tried);
    if (fails) deck = std::move(tried);
    return fails;
  };
  RandomDeck bare = deck;
  bare.before.clear();
  bare.after.clear();
  try_out(std::move(bare));
  for (std::size_t length = deck.lines.size() / 2; length > 0; length /= 2)
    for (std::size_t at = 1; at < deck.lines.size();) {
      RandomDeck tried = deck;
      const auto begin = tried.lines.begin() + static_cast<std::ptrdiff_t>(at);
      tried.lines.erase(begin, begin + static_cast<std::ptrdiff_t>(std::min(length, tried.lines.size() - at)));
      if (!try_out(std::move(tried))) at += length;
    }
  return deck;
}

}  // namespace pwlsim::test
