#pragma once
/// What people do to decks: slips of the keyboard, wrong numbers, and ways to write the same.

#include <string>
#include <vector>

#include "support/random.hpp"

namespace pwlsim::test {

/// Alters one line, not the title. Times and frequencies are not made shorter: the run would take its time rightly.
void make_mistake(std::vector<std::string>& lines, Random& random);

/// Other case, comments, continued lines, blanks: nothing that changes the meaning.
void write_otherwise(std::vector<std::string>& lines, Random& random);

}  // namespace pwlsim::test
