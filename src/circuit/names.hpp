#pragma once
/// Full names of a flat circuit, as .save, .ic and controlled sources look them up.

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "circuit/circuit.hpp"

namespace pwlsim::circuit {

/// Refers to the circuit, which must not change meanwhile. ':' counts as '.' if a name is not known as written.
class NameIndex {
 public:
  explicit NameIndex(const FlatCircuit& circuit);

  [[nodiscard]] std::optional<model::NodeIndex> node(std::string_view name) const;
  /// -1 if there is none.
  [[nodiscard]] int element(std::string_view name) const;
  /// Elements with the same name as an earlier one.
  [[nodiscard]] const std::vector<int>& second_ones() const { return second_ones_; }

  /// Candidates for suggestions; none in a circuit so large that a search for every error would take long.
  [[nodiscard]] std::vector<std::string> node_names() const;
  /// Names, without `prefix`, of all elements whose names begin with it.
  [[nodiscard]] std::vector<std::string> element_names(std::string_view prefix = {}) const;
  /// Whether some element is inside a call of that name.
  [[nodiscard]] bool is_call(std::string_view name) const;

 private:
  static constexpr std::size_t largest_search = 10000;

  const FlatCircuit& circuit_;
  std::unordered_map<std::string, int> element_by_name_;
  std::vector<int> second_ones_;
};

}  // namespace pwlsim::circuit
