#include "circuit/unused_subcircuits.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/census.hpp"

namespace pwlsim::circuit {
namespace {

using Set = std::unordered_set<const Definition*>;

/// Also those that a damaged card may call: any of its words may be the name.
void note_called(const Definition& from, const netlist::Card& card, std::vector<const Definition*>& found) {
  for (const netlist::Item& item : card.items)
    if (const Definition* called = find_subcircuit(from, item.text)) found.push_back(called);
}

Set called_subcircuits(const Definitions& definitions) {
  std::vector<const Definition*> open{definitions.all.front().get()};
  Set called;
  while (!open.empty()) {
    const Definition* definition = open.back();
    open.pop_back();
    if (!called.insert(definition).second) continue;
    for (const netlist::Card* card : definition->elements)
      if (is_call(*card)) note_called(*definition, *card, open);
  }
  return called;
}

/// What says where subcircuits begin and end, and so what belongs to them.
bool is_of_structure(const Diagnostic& diagnostic) {
  static constexpr std::string_view ids[] = {"E-missing-ends", "E-misplaced", "E-ends-name"};
  return std::find(std::begin(ids), std::end(ids), diagnostic.id) != std::end(ids);
}

bool is_within(const SourceSpan& span, const SourceSpan& body) {
  return span.file == body.file && span.begin >= body.begin && span.end <= body.end;
}

/// The innermost of the definitions that hold the place; null: the deck itself.
const Definition* holder_of(const SourceSpan& span, const Definitions& definitions) {
  const Definition* holder = nullptr;
  for (const auto& definition : definitions.all)
    if (definition->parent != nullptr && is_within(span, definition->body) &&
        (holder == nullptr || is_within(definition->body, holder->body)))
      holder = definition.get();
  return holder;
}

}  // namespace

std::size_t soften_unused_subcircuits(const Definitions& definitions, Reporter& reporter) {
  if (!reporter.failed() || definitions.all.size() < 2) return 0;
  const Set called = called_subcircuits(definitions);
  return reporter.soften([&](Diagnostic& diagnostic) {
    if (is_of_structure(diagnostic)) return false;
    const Definition* holder = holder_of(diagnostic.span, definitions);
    const auto is_of_its_name = [&](const Definition* other) { return same_name(other->name, holder->name); };
    if (holder == nullptr || std::any_of(called.begin(), called.end(), is_of_its_name)) return false;
    diagnostic.id = "W-unused-subckt";
    diagnostic.text = fmt::format("in subcircuit {}, which nothing calls: {}", holder->name, diagnostic.text);
    return true;
  });
}

}  // namespace pwlsim::circuit
