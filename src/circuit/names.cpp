#include "circuit/names.hpp"

#include <algorithm>

#include "base/names.hpp"

namespace pwlsim::circuit {
namespace {

std::string with_dots(std::string_view name) {
  std::string dotted(name);
  std::replace(dotted.begin(), dotted.end(), ':', '.');
  return dotted;
}

}  // namespace

NameIndex::NameIndex(const FlatCircuit& circuit) : circuit_(circuit) {
  element_by_name_.reserve(circuit.instances.size());
  for (std::size_t k = 0; k < circuit.instances.size(); ++k) {
    const auto index = static_cast<int>(k);
    if (!element_by_name_.try_emplace(without_case(circuit.instances[k].name), index).second) second_ones_.push_back(index);
  }
}

std::optional<model::NodeIndex> NameIndex::node(std::string_view name) const {
  if (const auto found = circuit_.find_node(name)) return found;
  return circuit_.find_node(with_dots(name));
}

int NameIndex::element(std::string_view name) const {
  for (const std::string& key : {without_case(name), without_case(with_dots(name))}) {
    if (const auto found = element_by_name_.find(key); found != element_by_name_.end()) return found->second;
  }
  return -1;
}

std::vector<std::string> NameIndex::node_names() const {
  std::vector<std::string> names;
  if (circuit_.nodes().size() > largest_search) return names;
  for (const model::Label& node : circuit_.nodes()) names.push_back(node.name);
  return names;
}

std::vector<std::string> NameIndex::element_names(std::string_view prefix) const {
  std::vector<std::string> names;
  if (circuit_.instances.size() > largest_search) return names;
  for (const elements::Instance& instance : circuit_.instances) {
    if (instance.name.starts_with(prefix)) names.push_back(instance.name.substr(prefix.size()));
  }
  return names;
}

bool NameIndex::is_call(std::string_view name) const {
  const std::string prefix = with_dots(name) + ".";
  return std::any_of(circuit_.instances.begin(), circuit_.instances.end(), [&](const elements::Instance& instance) {
    return same_name(std::string_view(instance.name).substr(0, prefix.size()), prefix);
  });
}

}  // namespace pwlsim::circuit
