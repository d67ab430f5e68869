#include "spice/ngspice.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "base/names.hpp"

namespace pwlsim::spice {
namespace {

bool tells_failure(std::string_view line) {
  static constexpr std::array<std::string_view, 9> marks{"error",  "too small",  "singular", "aborted",     "no convergence",
                                                         "failed", "can't find", "unknown",  "not converge"};
  const std::string plain = without_case(line);
  if (plain.find("init file") != std::string::npos || plain.find("spinit") != std::string::npos) return false;
  return std::any_of(marks.begin(), marks.end(), [&](std::string_view mark) { return plain.find(mark) != std::string::npos; });
}

/// The first lines that tell of a failure, each once.
std::string words_of(const std::string& log) {
  constexpr std::size_t most = 3;
  std::vector<std::string> lines;
  std::istringstream text(log);
  for (std::string line; std::getline(text, line) && lines.size() < most;) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (tells_failure(line) && std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
  }
  std::string words;
  for (const std::string& line : lines) words += (words.empty() ? "" : "; ") + line;
  return words;
}

double analysis_seconds(const std::string& log) {
  constexpr std::string_view mark = "Total analysis time (seconds) = ";
  const std::size_t at = log.find(mark);
  return at == std::string::npos ? 0.0 : std::strtod(log.c_str() + at + mark.size(), nullptr);
}

}  // namespace

std::optional<std::string> find_ngspice() { return find_program("ngspice"); }

NgspiceRun run_ngspice(const std::string& program, const std::string& deck, const ProcessLimits& limits) {
  NgspiceRun run;
  const TemporaryFolder folder;
  std::ofstream file(folder.made() ? folder.file("deck.cir") : "");
  file << deck;
  file.close();
  ProcessEnd end;
  if (folder.made() && file)
    end = run_process({program, "-n", "-b", "-r", folder.file("deck.raw"), folder.file("deck.cir")}, folder.file("log"), limits);
  if (!end.started) {
    run.words = "ngspice could not be started, or there is no space for its files";
    return run;
  }
  const std::string log = read_bytes(folder.file("log"));
  run.raw = waveform::read_raw(read_bytes(folder.file("deck.raw")));
  run.ended = end.succeeded;
  run.words = end.in_time ? words_of(log) : "stopped: it took too long";
  run.seconds = end.cpu_seconds;
  run.seconds_analysis = analysis_seconds(log);
  return run;
}

}  // namespace pwlsim::spice
