/// Random passive networks: see random_network.hpp for what they are, examination.hpp for what must hold, agreement.hpp for the
/// independent solution beside them.
#include <catch2/catch.hpp>

#include "property/survey.hpp"

using namespace pwlsim::test;

namespace {

constexpr double most_refused = 0.3;  ///< share of networks whose linear equations may be singular
constexpr int long_run = 2000;        ///< networks of a family

void check_family(const std::string& name, int networks, int known, const Checks& checks) {
  const Survey result = survey(family(name), networks, checks);
  for (const auto& failure : result.failures) UNSCOPED_INFO(failure);
  INFO(result.wrong << " of " << networks << " networks failed, " << result.refused << " were refused");
  CHECK(result.wrong <= known);
  CHECK(result.refused < most_refused * networks);
}

void check_properties(const std::string& name, int networks) { check_family(name, networks, family(name).known, {true, false}); }

void check_agreement(const std::string& name, int networks) { check_family(name, networks, 0, {false, true}); }

void check_all(const std::string& name) { check_family(name, long_run, family(name).known_long, {true, true}); }

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

TEST_CASE("2,000 networks of all parts", "[property][long]") { check_all("all parts"); }
TEST_CASE("2,000 networks without sources", "[property][long]") { check_all("no sources"); }
TEST_CASE("2,000 networks of little resistance", "[property][long]") { check_all("little resistance"); }
TEST_CASE("2,000 networks of many diodes", "[property][long]") { check_all("many diodes"); }
TEST_CASE("2,000 networks that float", "[property][long]") { check_all("floating"); }
TEST_CASE("2,000 networks of up to twelve ports", "[property][long]") { check_all("up to twelve ports"); }
