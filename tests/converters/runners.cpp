#include "converters/runners.hpp"

#include <cstdlib>
#include <sstream>

#include "random_decks/deck_trial.hpp"
#include "support/spawn.hpp"

namespace pwlsim::test::converters {
namespace {

std::vector<std::vector<double>> read_rows(const std::string& csv) {
  std::vector<std::vector<double>> result;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::vector<double> row;
    const char* at = line.c_str();
    for (bool first = true; *at != '\0'; first = false) {
      char* end = nullptr;
      const double value = std::strtod(at, &end);
      if (end == at) break;
      if (!first) row.push_back(value);
      at = *end == ',' ? end + 1 : end;
    }
    result.push_back(std::move(row));
  }
  return result;
}

/// The ids in brackets: `warning[W-certificate]`.
std::string ids_of(const std::string& messages) {
  std::string result;
  for (std::size_t at = messages.find('['); at != std::string::npos; at = messages.find('[', at + 1)) {
    const std::size_t end = messages.find(']', at);
    if (end == std::string::npos || at + 2 >= messages.size() || messages[at + 2] != '-') continue;
    const std::string id = messages.substr(at + 1, end - at - 1);
    if (result.find(id) == std::string::npos) result += (result.empty() ? "" : " ") + id;
  }
  return result;
}

std::vector<std::string> words(const std::vector<std::string>& options) {
  std::vector<std::string> result{"deck.net", "-o", "-", "--no-progress"};
  result.insert(result.end(), options.begin(), options.end());
  return result;
}

class InnerProgram : public Program {
 public:
  ProgramAnswer run(const std::string& deck, const std::vector<std::string>& options) override {
    folder_.write("deck.net", deck);
    const test::Trial trial = runner_->run(folder_, words(options));
    return {trial.status, ids_of(trial.err), read_rows(trial.out)};
  }

 private:
  Scratch folder_;
  std::unique_ptr<TrialRunner> runner_ = make_inner_runner();
};

class SpawnedProgram : public Program {
 public:
  explicit SpawnedProgram(std::string path) : path_(std::move(path)) {}
  ProgramAnswer run(const std::string& deck, const std::vector<std::string>& options) override {
    folder_.write("deck.net", deck);
    SpawnOptions spawn;
    spawn.program = path_;
    spawn.folder = folder_.path().string();
    spawn.seconds = 60.0;
    const Finished finished = run_program(words(options), spawn);
    return {finished.status, ids_of(finished.err), read_rows(finished.out)};
  }

 private:
  std::string path_;
  Scratch folder_;
};

}  // namespace

std::unique_ptr<Program> make_inner_program() { return std::make_unique<InnerProgram>(); }
std::unique_ptr<Program> make_spawned_program(const std::string& path) { return std::make_unique<SpawnedProgram>(path); }

}  // namespace pwlsim::test::converters
