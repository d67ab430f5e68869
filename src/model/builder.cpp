#include "model/builder.hpp"

#include "base/names.hpp"

namespace pwlsim::model {

LinearForm voltage_between(NodeIndex p, NodeIndex n, double coefficient) {
  LinearForm form;
  if (p == n) return form;
  if (p != ground) form.push_back({Term::Kind::node_voltage, p, coefficient});
  if (n != ground) form.push_back({Term::Kind::node_voltage, n, -coefficient});
  return form;
}

Term constant(double value) { return {Term::Kind::one, 0, value}; }

void accumulate(LinearForm& sum, const LinearForm& form, double factor) {
  for (Term term : form) {
    term.coefficient *= factor;
    sum.push_back(term);
  }
}

NodeIndex NetworkBuilder::node(std::string_view name, SourceSpan where) {
  std::string key = without_case(name);
  if (is_ground_name(key)) return ground;
  const auto next = static_cast<NodeIndex>(network_.nodes.size());
  const auto [entry, is_new] = node_by_name_.try_emplace(std::move(key), next);
  if (is_new) network_.nodes.push_back({std::string(name), where});
  return entry->second;
}

std::optional<NodeIndex> NetworkBuilder::find_node(std::string_view name) const {
  const std::string key = without_case(name);
  if (is_ground_name(key)) return ground;
  const auto entry = node_by_name_.find(key);
  if (entry == node_by_name_.end()) return std::nullopt;
  return entry->second;
}

NodeIndex NetworkBuilder::inner_node(Label label) {
  network_.nodes.push_back(std::move(label));
  return static_cast<NodeIndex>(network_.nodes.size()) - 1;
}

}  // namespace pwlsim::model
