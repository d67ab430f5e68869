// --check over all shipped decks and validation cases: the two engines share neither extraction, modes, selection nor event search, so what they agree on
// has an independent witness.

#include <catch2/catch.hpp>
#include <filesystem>
#include <set>

#include "support/json.hpp"
#include "support/scratch.hpp"
#include "support/spawn.hpp"

using namespace pwlsim::test;
namespace fs = std::filesystem;

namespace {

/// Without a verdict: two events a nanosecond apart in a run of a second, where the sparse engine's error shrinks irregularly.
const std::set<std::string> undecided{"nanosecond"};
/// Not tried: the sparse engine takes 13 s for rings of picofarads, and does not end within the 20 s of a check where a lossless tank meets a clamp.
const std::set<std::string> too_slow{"buck_parasitic", "tank_clamp"};

/// Whether the deck was compared.
bool checked(const fs::path& deck, const std::string& name) {
  if (too_slow.count(name) != 0) return false;
  const Scratch scratch;
  const Finished finished = run_program({fs::absolute(deck).string(), "-o", "rows.csv", "--check", "--json", "--quiet"},
                                        {.folder = scratch.path().string(), .seconds = 100.0});
  INFO(name << ", status " << finished.status << ": " << finished.err);
  if (finished.err.find("E-check-sweep") != std::string::npos || finished.err.find("E-no-transient") != std::string::npos) return false;
  const Json check = read_json(finished.out)["check"];
  INFO(check["reason"].string);
  CHECK(finished.status == 0);
  CHECK(check["verdict"].string != "differs");
  if (undecided.count(name) == 0) CHECK(check["verdict"].string == "agrees");
  return true;
}

}  // namespace

TEST_CASE("--check: the engines agree on the decks of netlists/", "[regression]") {
  int compared = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(PWLSIM_SOURCE_DIR) / "netlists"))
    if (entry.path().extension() == ".net" && checked(entry.path(), entry.path().stem().string())) ++compared;
  CHECK(compared >= 15);
}

TEST_CASE("--check: the engines agree on the validation cases", "[regression]") {
  int compared = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(PWLSIM_SOURCE_DIR) / "validation/cases"))
    if (checked(entry.path() / "circuit.net", entry.path().filename().string())) ++compared;
  CHECK(compared >= 20);
}
