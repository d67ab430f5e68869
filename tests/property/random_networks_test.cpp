/// Random passive networks: see random_network.hpp for what they are, examination.hpp for what must hold, agreement.hpp for the
/// independent solution beside them.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>

#include "property/agreement.hpp"
#include "property/independent.hpp"
#include "property/program_run.hpp"
#include "property/survey.hpp"

using namespace pwlsim::test;

namespace {

constexpr double most_refused = 0.3;  ///< share of networks whose linear equations may be singular
constexpr int long_run = 2000;        ///< networks of a family

void check_family(const std::string& name, int networks, const Checks& checks) {
  const Survey result = survey(family(name), networks, checks);
  for (const auto& failure : result.failures) UNSCOPED_INFO(failure);
  INFO(result.wrong << " of " << networks << " networks failed, " << result.refused << " were refused");
  CHECK(result.wrong == 0);
  CHECK(result.refused < most_refused * networks);
}

void check_properties(const std::string& name, int networks) { check_family(name, networks, {true, false}); }

void check_agreement(const std::string& name, int networks) { check_family(name, networks, {false, true}); }

void check_all(const std::string& name) { check_family(name, long_run, {true, true}); }

/// Of a state, between the program's answers for two networks, relative to the largest value of all states of the first that have its unit.
double largest_relative_change(const RandomNetwork& network, const RandomNetwork& beside) {
  std::vector<double> times;
  for (int k = 0; k <= 20; ++k) times.push_back(network.stop * k / 20);
  const auto rows = run_program(to_model(network), times).rows, others = run_program(to_model(beside), times).rows;
  if (rows.size() != times.size() || others.size() != times.size()) return 0.0;
  const auto states = states_of(network);
  double largest[2] = {0.0, 0.0}, change[2] = {0.0, 0.0};
  for (std::size_t k = 0; k < times.size(); ++k)
    for (std::size_t i = 0; i < states.size(); ++i) {
      const int unit = states[i].kind == NetworkPart::Kind::capacitor ? 0 : 1;
      largest[unit] = std::max(largest[unit], std::abs(rows[k][i + 1]));
      change[unit] = std::max(change[unit], std::abs(rows[k][i + 1] - others[k][i + 1]));
    }
  return std::max(largest[0] > 0.0 ? change[0] / largest[0] : 0.0, largest[1] > 0.0 ? change[1] / largest[1] : 0.0);
}

}  // namespace

TEST_CASE("networks of all parts", "[property]") { check_properties("all parts", 600); }

TEST_CASE("networks without sources never gain energy", "[property]") { check_properties("no sources", 500); }

TEST_CASE("networks of stores and diodes with little resistance: capacitor loops, inductor cutsets, jumps", "[property]") {
  check_properties("little resistance", 500);
}

TEST_CASE("networks of many diodes", "[property]") { check_properties("many diodes", 500); }

TEST_CASE("networks that float when their diodes and switches block", "[property]") { check_properties("floating", 400); }

TEST_CASE("networks of up to twelve ports", "[property]") { check_properties("up to twelve ports", 300); }

TEST_CASE("networks of diodes with forward and reverse resistance: modes up to 10^12 times faster than what one looks at", "[property]") {
  check_properties("real diodes", 500);
}

TEST_CASE("implicit Euler comes towards the program's states as its steps shrink", "[property]") {
  check_agreement("all parts", 30);
  check_agreement("no sources", 30);
  check_agreement("little resistance", 30);
  check_agreement("many diodes", 30);
  check_agreement("floating", 30);
  check_agreement("up to twelve ports", 20);
}

// The comparison is worth what it notices: implicit Euler is given a network of which one store is 3 % larger. Of those that matter to the
// program's states by a percent of the largest or more, it must notice all but a few whose effect comes when the window has been shortened.
TEST_CASE("implicit Euler on another network does not come towards the program's states", "[property]") {
  constexpr double other = 1.03, matters = 0.01, unnoticed = 0.05;
  int altered = 0, noticed = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const RandomNetwork network = make_random_network(seed, family("all parts").recipe);
    for (std::size_t i = 0; i < network.parts.size(); ++i) {
      if (!network.parts[i].is_state()) continue;
      RandomNetwork beside = network;
      beside.parts[i].value *= other;
      if (largest_relative_change(network, beside) < matters) continue;
      ++altered;
      if (compare_with_independent(network, beside).kind == Agreement::Kind::wrong) ++noticed;
    }
  }
  INFO(noticed << " of " << altered << " noticed");
  CHECK(altered > 20);
  CHECK(noticed >= (1.0 - unnoticed) * altered);
}

// A node that only a diode and two open switches meet: its potential is open, and rounding had been taken for a constraint of it.
TEST_CASE("a node behind open switches and a blocking diode leaves the others alone", "[property]") {
  const Agreement agreement = compare_with_independent(make_random_network(70'416, family("up to twelve ports").recipe));
  INFO(agreement.what << agreement.detail);
  CHECK(agreement.kind == Agreement::Kind::agrees);
}

namespace {

constexpr int sparse_networks = 300;  ///< of a family

/// Of the sparse engine's states from the exact engine's. Negative: one of the two did not finish.
double distance_of_engines(const RandomNetwork& network, double reltol) {
  std::vector<double> times;
  for (int k = 1; k <= 20; ++k) times.push_back(network.stop * k / 20);
  const auto exact = run_program(to_model(network), times), sparse = run_program_sparse(to_model(network), times, reltol);
  if (exact.finding.kind != Finding::Kind::fine) return 0.0;
  if (sparse.finding.kind != Finding::Kind::fine) return -1.0;
  return energy_distance(network, exact, sparse);
}

}  // namespace

// Errors of steps of order 2 whose local error is reltol; undamped tanks gather them over hundreds of periods.
TEST_CASE("random networks on the sparse engine agree with the exact one", "[property]") {
  constexpr double reltol = 1e-5;
  const double bound = 20.0 * std::cbrt(reltol * reltol);
  // Seeds that fail today, each by not finishing (docs/developer/open-ends.md). No other may fail; one that passes is to be removed here.
  static const std::map<std::string, std::set<std::uint64_t>> known{{"all parts", {}},         {"no sources", {10'033}},
                                                                    {"little resistance", {}}, {"many diodes", {}},
                                                                    {"floating", {40'273}},    {"up to twelve ports", {}}};
  const auto [name, expected] = GENERATE(from_range(known));
  const Family& f = family(name);
  std::set<std::uint64_t> unlike;
  for (int i = 0; i < sparse_networks; ++i) {
    const std::uint64_t seed = f.first_seed + static_cast<std::uint64_t>(i);
    const double distance = distance_of_engines(make_random_network(seed, f.recipe), reltol);
    if (distance >= 0.0 && distance <= bound) continue;
    unlike.insert(seed);
    UNSCOPED_INFO(seed << ": " << (distance < 0.0 ? "not finished" : "differs by " + std::to_string(distance)));
  }
  INFO(name << ": " << unlike.size() << " of " << sparse_networks << " networks");
  CHECK(std::includes(expected.begin(), expected.end(), unlike.begin(), unlike.end()));
  if (unlike != expected) WARN(name << ": a network that is known to fail passes; remove it from the list");
}

TEST_CASE("2,000 networks of all parts", "[property][long]") { check_all("all parts"); }
TEST_CASE("2,000 networks without sources", "[property][long]") { check_all("no sources"); }
TEST_CASE("2,000 networks of little resistance", "[property][long]") { check_all("little resistance"); }
TEST_CASE("2,000 networks of many diodes", "[property][long]") { check_all("many diodes"); }
TEST_CASE("2,000 networks that float", "[property][long]") { check_all("floating"); }
TEST_CASE("2,000 networks of up to twelve ports", "[property][long]") { check_all("up to twelve ports"); }
