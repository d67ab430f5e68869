#pragma once
/// Full names of a flat circuit, as .save, .ic and controlled sources look them up.

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "circuit/circuit.hpp"

namespace pwlsim::circuit {

/// Refers to the circuit, which must not change meanwhile. ':' counts as '.' where a name is not known as it stands.
class NameIndex {
 public:
  explicit NameIndex(const Circuit& circuit);

  [[nodiscard]] std::optional<model::NodeIndex> node(std::string_view name) const;
  /// -1 where there is none.
  [[nodiscard]] int element(std::string_view name) const;
  /// Elements that bear the name of one before them.
  [[nodiscard]] const std::vector<int>& second_ones() const { return second_ones_; }

  /// Candidates for suggestions; none in a circuit so large that looking through them for every error would take long.
  [[nodiscard]] std::vector<std::string> node_names() const;
  /// Names without `prefix` of the elements that stand directly or deeper behind it.
  [[nodiscard]] std::vector<std::string> element_names(std::string_view prefix = {}) const;
  /// Some element stands inside a call of that name.
  [[nodiscard]] bool is_call(std::string_view name) const;

 private:
  static constexpr std::size_t largest_search = 10000;

  const Circuit& circuit_;
  std::unordered_map<std::string, int> element_by_name_;
  std::vector<int> second_ones_;
};

}  // namespace pwlsim::circuit
