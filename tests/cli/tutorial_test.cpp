// docs/tutorial: the page shows its decks as they are, and what they print; so does the page of sweeps.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <regex>
#include <sstream>

#include "cli/run_in.hpp"

using namespace pwlsim::test;

namespace {

/// Between the page, written on one machine, and the run, on any.
constexpr double same = 1e-9;

std::string tutorial(const std::string& name) { return std::string(PWLSIM_SOURCE_DIR "/docs/tutorial/") + name; }
std::string reference(const std::string& name) { return std::string(PWLSIM_SOURCE_DIR "/docs/reference/") + name; }

std::vector<std::string> lines_of_text(const std::string& text) {
  std::vector<std::string> result;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) result.push_back(line);
  return result;
}

/// name = value, a line each.
std::map<std::string, double> results(const std::string& text) {
  std::map<std::string, double> found;
  for (const auto& line : lines_of_text(text))
    if (const auto at = line.find(" = "); at != std::string::npos && line.find(' ', at + 3) == std::string::npos)
      found[line.substr(line.find_first_not_of(' '), at - line.find_first_not_of(' '))] = std::strtod(line.c_str() + at + 3, nullptr);
  return found;
}

std::vector<double> numbers(const std::string& line) {
  std::vector<double> found;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) found.push_back(std::strtod(cell.c_str(), nullptr));
  return found;
}

/// A page shows, indented, a table that was printed.
void check_table(const std::vector<std::string>& page, const std::vector<std::string>& table, std::size_t rows) {
  REQUIRE(table.size() == rows);
  auto row = std::find(page.begin(), page.end(), "    " + table[0]);
  for (std::size_t k = 1; k < table.size(); ++k) {
    REQUIRE(page.end() - row > 1);
    const auto found = numbers(table[k]), shown = numbers(*++row);
    REQUIRE(shown.size() == found.size());
    for (std::size_t i = 0; i < found.size(); ++i) CHECK(shown[i] == Approx(found[i]).epsilon(same));
  }
}

}  // namespace

TEST_CASE("the tutorial shows its first deck line by line", "[golden]") {
  const std::string page = read_file(tutorial("README.md"));
  for (const auto& line : lines_of_text(read_file(tutorial("buck.net")))) {
    CAPTURE(line);
    CHECK((line == ".end" || page.find("    " + line + "\n") != std::string::npos));
  }
}

// An ideal buck converter in continuous conduction gives D·Vin on average and loses nothing (Erickson and Maksimović, Fundamentals of
// Power Electronics, eq. 2.7).
TEST_CASE("the first deck of the tutorial measures what theory says and what the page shows", "[golden]") {
  constexpr double expected = 0.45 * 24.0, rounding = 1e-11;
  const Scratch scratch;
  const Finished finished = run_in(scratch, {tutorial("buck.net")});
  REQUIRE(finished.status == 0);
  const auto found = results(finished.out), shown = results(read_file(tutorial("README.md")));
  REQUIRE(found.size() == 5);
  CHECK(found.at("vout") == Approx(expected).epsilon(rounding));
  CHECK(found.at("efficiency") == Approx(1.0).epsilon(rounding));
  for (const auto& [name, value] : found) {
    CAPTURE(name);
    REQUIRE(shown.count(name) == 1);
    CHECK(shown.at(name) == Approx(value).epsilon(same));
  }
}

TEST_CASE("the sweep of the tutorial prints what the page shows", "[golden]") {
  const Scratch scratch;
  const Finished finished = run_in(scratch, {tutorial("losses.net")});
  REQUIRE(finished.status == 0);
  check_table(lines_of_text(read_file(tutorial("README.md"))), lines_of_text(finished.out), 5);
}

// A boost converter in continuous conduction gives Vin/(1 - D) on average, to the ripple of its output (the same book, eq. 2.36).
TEST_CASE("the sweep of the reference prints what the page shows, near to what theory says", "[golden]") {
  constexpr double ripple = 1e-3;
  const Scratch scratch;
  const Finished finished = run_in(scratch, {reference("boost_duty.net"), "--plot", "boost.svg"});
  REQUIRE(finished.status == 0);
  const auto table = lines_of_text(finished.out);
  check_table(lines_of_text(read_file(reference("sweeps.md"))), table, 6);
  for (std::size_t k = 1; k < table.size(); ++k) {
    const auto row = numbers(table[k]);
    CHECK(row[1] == Approx(12.0 / (1.0 - row[0])).epsilon(ripple));
  }
}

TEST_CASE("the first table of the README has the numbers of docs/validation/report.md", "[golden]") {
  const std::string root = PWLSIM_SOURCE_DIR;
  const auto readme = lines_of_text(read_file(root + "/README.md")), report = lines_of_text(read_file(root + "/docs/validation/report.md"));
  static const std::regex row(R"(\| \[[^\]]*\]\(validation/cases/([a-z_]+)\) \| ([^ ]+) ms \| ([^ ]+) ms \| ([^ ]+) ms \| ([^ ]+) \|)");
  std::size_t count = 0;
  for (const std::string& line : readme) {
    std::smatch found;
    if (!std::regex_match(line, found, row)) continue;
    ++count;
    INFO(line);
    const std::string head =
        "| [" + found[1].str() + "](work-precision/" + found[1].str() + ".svg) | " + found[4].str() + " (" + found[5].str() + ") |";
    const auto measured = std::find_if(report.begin(), report.end(), [&](const std::string& each) { return each.rfind(head, 0) == 0; });
    REQUIRE(measured != report.end());
    CHECK(measured->find(" | " + found[2].str() + " (") != std::string::npos);
    CHECK(measured->find(" | " + found[3].str() + " (") != std::string::npos);
  }
  CHECK(count == 5);
  const std::string mean = "of ngspice 244 at 0.001 (8 circuits), 435 at 0.0001";
  CHECK(std::any_of(report.begin(), report.end(), [&](const std::string& line) { return line.find(mean) != std::string::npos; }));
}
