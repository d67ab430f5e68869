#pragma once
/// Decks with rows without end.

#include <string>

namespace pwlsim::test {

/// Next to no events.
inline const std::string many_rows = "many rows\nV1 a 0 SIN(0 1 50)\nR1 a 0 1k\n.tran 1n 0.9\n.end\n";
/// Two events a period.
inline const std::string many_rectified_rows = "many rows\nV1 a 0 SIN(0 1 50)\nD1 a b DI\nR1 b 0 1k\n.model DI D\n.tran 1n 0.9\n.end\n";

}  // namespace pwlsim::test
