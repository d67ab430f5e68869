/// hard_cases_table [networks]: writes docs/validation/hard-cases.md to standard output. `networks`: of each family (2,000).
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <future>
#include <string>
#include <vector>

#include "property/survey.hpp"
#include "tables/hard_cases.hpp"

using namespace pwlsim::test;

namespace {

constexpr int default_networks = 2000;
constexpr double loosest = 1e-9;

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

std::string text_of(const std::optional<double>& value) { return value ? fmt::format("{:.1e}", *value) : "–"; }

bool holds(const Measured& measured) {
  if (!measured.problem.empty()) return false;
  return measured.touch || (measured.value.value_or(0.0) <= loosest && measured.event_time.value_or(0.0) <= loosest);
}

int print_cases() {
  int failed = 0;
  fmt::print("| # | system | tests (tests/…_test.cpp) | worst error of a signal | of an event's time |\n| --- | --- | --- | --- | --- |\n");
  for (const HardCase& item : hard_cases()) {
    const Measured measured = measure(item);
    std::string value = measured.outcome;
    if (measured.value) value += (value.empty() ? "" : "; ") + text_of(measured.value);
    if (!holds(measured)) {
      ++failed;
      value = "**fails** " + measured.problem + " " + value;
    }
    fmt::print("| {} | {} | {} | {} | {} |\n", item.number, item.system, item.tests, value, text_of(measured.event_time));
  }
  return failed;
}

std::string agreement(const Survey& result) {
  return fmt::format("{} ({} whole, {} windows) | {:.1e} | {:.1e} | {:.2f}", result.compared, result.whole, result.windows,
                     result.difference, result.extrapolated, result.order);
}

int print_networks(int networks) {
  int failed = 0;
  std::string failures;
  fmt::print(
      "| family | run | refused | ports | failures | complementarity | KCL/KVL | energy | compared | difference | extrapolated | order |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  std::vector<std::future<Survey>> surveys;
  for (const Family& family : families())
    surveys.push_back(std::async(std::launch::async, [&family, networks] { return survey(family, networks, {true, family.independent}); }));
  for (std::size_t i = 0; i < surveys.size(); ++i) {
    const Family& family = families()[i];
    const Survey result = surveys[i].get();
    const std::string last = family.independent ? agreement(result) : "– | – | – | –";
    fmt::print("| {} | {} | {} | {} | {} | {:.1e} | {:.1e} | {:.1e} | {} |\n", family.name, result.networks, result.refused,
               result.most_ports, result.wrong, result.worst.complementarity, result.worst.kcl_kvl, result.worst.energy, last);
    std::fflush(stdout);
    failed += result.wrong;
    for (const auto& failure : result.failures) failures += "- " + family.name + ", " + failure.substr(0, failure.find('\n')) + "\n";
  }
  if (!failures.empty()) fmt::print("\nFailures:\n\n{}", failures);
  return failed;
}

}  // namespace

int main(int argc, char** argv) {
  const int networks = argc > 1 ? std::atoi(argv[1]) : default_networks;
  fmt::print(
      "# Hard cases and random networks\n\nMade by `validation/hard_cases{}` on {:%Y-%m-%d}, {}. Numbers of random networks depend "
      "only on their "
      "seeds.\n\n## The hard cases\n\n",
      argc > 1 ? fmt::format(" {}", networks) : "", fmt::gmtime(std::chrono::system_clock::now()), processor());
  fmt::print(
      "Circuits and systems with closed-form answers, which no simulator computed. Errors of signals are relative to the largest value of "
      "the signal, those of "
      "times to the length of\nthe run. References: tests/reference, 20 digits (validation/references), or a formula in the table's "
      "program. Case 31 touches its stop "
      "with zero speed: a double root\ncosts half the digits of its time.\n\n");
  int failed = print_cases();
  fmt::print(
      "\n## Random passive networks\n\nEach is run three times (as it is, renumbered, with half the output step); residuals are the "
      "largest of the certificates. "
      "Refused: its linear equations are singular\nin every position of the diodes. It is compared with an independent solution: implicit "
      "Euler with "
      "every step solved by trying the "
      "positions of the diodes, steps h, h/2, h/4, h/8\n(tests/property/agreement.hpp). Difference: between the program and h/8, in the "
      "norm "
      "of stored energy, relative; "
      "extrapolated: from 2 x(h/8) − x(h/4); order: median over\nthe networks of log₂ of the factor by which halving h reduces the "
      "difference.\n\n");
  failed += print_networks(networks);
  return failed == 0 ? 0 : 1;
}
