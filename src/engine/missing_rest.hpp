#pragma once
/// The text about parts without a DC operating point.

#include <string>
#include <vector>

namespace pwlsim::engine {

struct MissingRest {
  std::vector<std::string> parts;     ///< "in the part with node a …", "S1 keeps toggling"
  std::vector<std::string> elements;  ///< switches among them

  [[nodiscard]] bool empty() const { return parts.empty(); }
  /// Switches that keep toggling each other.
  void add_restless(const std::vector<std::string>& names);
  void add(const MissingRest& other);
  /// "no DC operating point: …; …"; long lists are cut.
  [[nodiscard]] std::string text() const;
};

}  // namespace pwlsim::engine
