#include "circuit/circuit.hpp"

#include <algorithm>
#include <cassert>

#include "base/names.hpp"
#include "elements/catalogue.hpp"

namespace pwlsim::circuit {

bool HiddenParts::hold(std::string_view name) const {
  const std::size_t end = name.rfind('.');
  return end != std::string_view::npos && !names.empty() && names.contains(without_case(name.substr(0, end)));
}

bool FlatCircuit::is_ground(std::string_view name) const {
  return is_ground_name(name) || (!stands_for_ground.empty() && same_name(name, stands_for_ground));
}

std::string missing_ground(const FlatCircuit& circuit) {
  const elements::Instance* chosen = nullptr;
  for (const elements::Instance& instance : circuit.instances) {
    const auto touches = [](model::NodeIndex node) { return node == model::ground; };
    if (std::any_of(instance.nodes.begin(), instance.nodes.end(), touches)) return "";
    const bool is_source = instance.kind != nullptr && instance.kind->letter == 'V';
    if (instance.nodes.size() >= 2 && (chosen == nullptr || (is_source && chosen->kind->letter != 'V'))) chosen = &instance;
  }
  return chosen == nullptr || chosen->kind == nullptr ? "" : circuit.nodes()[static_cast<std::size_t>(chosen->nodes[1])].name;
}

model::NodeIndex FlatCircuit::node(std::string_view name, SourceSpan where) {
  if (is_ground(name)) return model::ground;
  const auto [entry, is_new] = node_by_name_.try_emplace(without_case(name), static_cast<model::NodeIndex>(nodes_.size()));
  if (is_new) nodes_.push_back({std::string(name), where});
  return entry->second;
}

bool FlatCircuit::add_node(std::string name, SourceSpan where, model::NodeIndex& index) {
  index = static_cast<model::NodeIndex>(nodes_.size());
  const bool is_new = node_by_name_.try_emplace(without_case(name), index).second;
  nodes_.push_back({std::move(name), where});
  return is_new;
}

std::optional<model::NodeIndex> FlatCircuit::find_node(std::string_view name) const {
  if (is_ground(name)) return model::ground;
  const auto entry = node_by_name_.find(without_case(name));
  if (entry == node_by_name_.end()) return std::nullopt;
  return entry->second;
}

elements::Instance& FlatCircuit::add(std::string name, const std::vector<std::string>& node_names) {
  const elements::Kind* kind = elements::find_kind(name.at(0));
  assert(kind != nullptr);
  elements::Instance instance;
  instance.kind = kind;
  instance.name = std::move(name);
  instance.values = elements::Values(kind->parameters);
  for (const std::string& node_name : node_names) instance.nodes.push_back(node(node_name));
  return instances.emplace_back(std::move(instance));
}

int FlatCircuit::add_model(std::string_view type, std::string name) {
  const elements::ModelKind* kind = elements::find_model_kind(type);
  assert(kind != nullptr);
  models.push_back({kind, std::move(name), {}, elements::Values(kind->parameters)});
  return static_cast<int>(models.size()) - 1;
}

}  // namespace pwlsim::circuit
