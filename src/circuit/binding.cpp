#include "circuit/binding.hpp"

#include <fmt/format.h>

#include "base/names.hpp"

namespace pwlsim::circuit {

model::NodeIndex Binding::node(Place& place, const netlist::Item& word) {
  if (place.prefix.empty() || is_ground_name(word.text)) return circuit_.node(word.text, word.span);
  const std::string key = without_case(word.text);
  if (const auto known = place.nodes.find(key); known != place.nodes.end()) return known->second;
  if (!place.is_made && is_global(key)) return circuit_.node(word.text, word.span);
  model::NodeIndex index = model::ground;
  if (!circuit_.add_node(place.prefix + word.text, word.span, index)) {
    reporter_.error("E-name-clash", word.span, fmt::format("two different nodes have the full name {}{}", place.prefix, word.text));
  }
  place.nodes.emplace(key, index);
  return index;
}

void Binding::note_two_values(const netlist::Card& card) {
  if (!circuit_.analyses.operating_point) return;
  reporter_.note("N-dc-value", card.name_span,
                 fmt::format("{} has a DC value and a waveform: .op takes the waveform just before t = 0", card.name));
}

}  // namespace pwlsim::circuit
