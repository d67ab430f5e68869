#pragma once
/// The program, started in a folder of the test.

#include <catch2/catch.hpp>

#include "support/scratch.hpp"
#include "support/spawn.hpp"

namespace pwlsim::test {

/// Failures of the test from here on show the status and the messages.
inline Finished run_in(const Scratch& scratch, const std::vector<std::string>& arguments, SpawnOptions options = {}) {
  options.folder = scratch.path().string();
  Finished finished = run_program(arguments, options);
  UNSCOPED_INFO("status " << finished.status << ", standard error: " << finished.err);
  return finished;
}

/// The deck as d.net, its rows as d.csv.
inline Finished run_deck(const Scratch& scratch, const std::string& deck) {
  scratch.write("d.net", deck);
  return run_in(scratch, {"d.net", "-o", "d.csv"});
}

/// Of a line `name = value` on standard output.
inline double value_of(const std::string& text, const std::string& name) {
  const std::size_t at = text.find(name + " = ");
  REQUIRE(at != std::string::npos);
  return std::stod(text.substr(at + name.size() + 3));
}

}  // namespace pwlsim::test
