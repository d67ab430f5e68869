#pragma once
/// What --json tells of a run.

#include <string>
#include <vector>

#include "cli/run_in.hpp"
#include "support/json.hpp"

namespace pwlsim::test {

/// Of the deck, with `more` arguments; the test ends where the run fails.
inline Json result_of(const Scratch& scratch, const std::string& deck, const std::vector<std::string>& more = {}) {
  scratch.write("deck.net", deck);
  std::vector<std::string> arguments{"deck.net", "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Finished finished = run_in(scratch, arguments);
  REQUIRE(finished.status == 0);
  return read_json(finished.out);
}

inline double measured(const Json& result, const std::string& name) {
  for (const Json& m : result["measurements"].array)
    if (m["name"].string == name) return m["value"].number;
  FAIL("no measurement " << name);
  return 0.0;
}

}  // namespace pwlsim::test
