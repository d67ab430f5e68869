#pragma once
/// A deck in a string, compiled; for tests.

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "circuit/compile.hpp"
#include "netlist/load.hpp"

namespace pwlsim::test {

struct CompiledDeck {
  SourceStore sources;
  Diagnostics diagnostics;
  std::optional<circuit::Compiled> compiled;

  [[nodiscard]] const model::Network& network() const { return compiled.value().network; }
  [[nodiscard]] std::string messages() const {
    std::string text;
    for (const Diagnostic& diagnostic : diagnostics.all()) text += render(diagnostic, sources) + "\n";
    return text;
  }
  [[nodiscard]] std::size_t count(std::string_view id) const {
    const auto& all = diagnostics.all();
    return static_cast<std::size_t>(std::count_if(all.begin(), all.end(), [&](const Diagnostic& d) { return d.id == id; }));
  }
};

/// The title line is added.
inline CompiledDeck compile_deck(std::string_view cards, const circuit::CompileOptions& options = {}) {
  CompiledDeck result;
  const netlist::Deck deck = netlist::parse("test.net", "title\n" + std::string(cards), result.sources, result.diagnostics);
  result.compiled = circuit::compile(deck, result.sources, result.diagnostics, options);
  return result;
}

/// The item of that name in a list of the network, whose labels bear the full names.
template <class Item>
const Item& named(const std::vector<Item>& list, std::string_view name) {
  const auto found = std::find_if(list.begin(), list.end(), [&](const Item& item) { return item.label.name == name; });
  if (found == list.end()) throw std::runtime_error("no item named " + std::string(name));
  return *found;
}

inline model::NodeIndex node_named(const model::Network& network, std::string_view name) {
  for (std::size_t k = 0; k < network.nodes.size(); ++k) {
    if (network.nodes[k].name == name) return static_cast<model::NodeIndex>(k);
  }
  throw std::runtime_error("no node named " + std::string(name));
}

inline std::vector<std::string> columns(const model::Network& network) {
  std::vector<std::string> names;
  for (const model::Signal& signal : network.signals) names.push_back(signal.name);
  return names;
}

}  // namespace pwlsim::test
