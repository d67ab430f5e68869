#pragma once
/// What the cards of a deck, or of one subcircuit, can refer to.

#include <map>
#include <string>
#include <vector>

namespace pwlsim::test {

struct DeckScope {
  std::vector<std::string> lines;
  std::vector<std::string> nodes;       ///< "0" is one of them
  std::vector<std::string> parameters;  ///< dimensionless, near one
  std::vector<std::string> functions;   ///< of one argument
  std::vector<std::string> elements;
  std::vector<std::string> measurable;  ///< elements whose current can control others
  std::vector<std::string> inductors;
  std::map<std::string, std::vector<std::string>> models;  ///< names by type
};

}  // namespace pwlsim::test
