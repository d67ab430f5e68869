#include "circuit/census.hpp"

#include <algorithm>
#include <optional>
#include <unordered_map>

#include <fmt/format.h>

#include "base/names.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Item;

struct Size {
  double elements = 0.0;  ///< in one copy
  double height = 0.0;    ///< subcircuits within one another below it
};

class Census {
 public:
  Census(const ExpansionLimits& limits, Reporter& reporter) : limits_(limits), reporter_(reporter) {}

  /// Absent after an error.
  std::optional<Size> measure(const Definition& definition) {
    if (const auto known = sizes_.find(&definition); known != sizes_.end()) return known->second;
    path_.push_back(&definition);
    Size size;
    for (const Card* card : definition.elements) {
      if (!add(definition, *card, size)) return std::nullopt;
    }
    path_.pop_back();
    sizes_[&definition] = size;
    return size;
  }

 private:
  bool add(const Definition& from, const Card& card, Size& size) {
    size.elements += 1.0;
    const Item* name = is_call(card) ? called_subcircuit(card) : nullptr;
    if (const Definition* called = name != nullptr ? find_subcircuit(from, name->text) : nullptr) {
      const std::optional<Size> inside = measure_call(*called, *name);
      if (!inside) return false;
      size.elements += inside->elements;
      size.height = std::max(size.height, 1.0 + inside->height);
    }
    return size.elements <= limits_.elements || too_many(card);
  }

  std::optional<Size> measure_call(const Definition& called, const Item& name) {
    if (const auto again = std::find(path_.begin(), path_.end(), &called); again != path_.end()) return recursion(name, again);
    const auto level = static_cast<double>(path_.size());
    if (level > limits_.depth) return too_deep(name);
    const std::optional<Size> size = measure(called);
    if (size && level + size->height > limits_.depth) return too_deep(name);
    return size;
  }

  std::optional<Size> recursion(const Item& name, std::vector<const Definition*>::iterator begin) {
    std::string circle;
    for (; begin != path_.end(); ++begin) circle += (*begin)->name + " -> ";
    reporter_.error("E-recursion", name.span, fmt::format("the subcircuit {} contains itself: {}{}", name.text, circle, name.text));
    return std::nullopt;
  }

  std::optional<Size> too_deep(const Item& name) {
    reporter_.error("E-too-deep", name.span,
                    fmt::format("subcircuits nest deeper than {}; .options max_subcircuit_depth= raises the limit", limits_.depth));
    return std::nullopt;
  }

  bool too_many(const Card& card) {
    reporter_.error("E-too-many-elements", card.name_span,
                    fmt::format("the deck expands to more than {} elements; .options max_elements= raises the limit", limits_.elements));
    return false;
  }

  const ExpansionLimits& limits_;
  Reporter& reporter_;
  std::vector<const Definition*> path_;
  std::unordered_map<const Definition*, Size> sizes_;
};

}  // namespace

bool is_call(const Card& card) { return card.made_call || lower_letter(card.name.front()) == 'x'; }

const Item* called_subcircuit(const Card& card) {
  const Item* name = nullptr;
  for (const Item& item : card.items) {
    if (item.kind == Item::Kind::assignment || same_name(item.text, "params:")) break;
    if (item.kind == Item::Kind::word) name = &item;
  }
  return name;
}

bool check_expansion(const Definitions& definitions, const ExpansionLimits& limits, Reporter& reporter) {
  return Census(limits, reporter).measure(*definitions.all.front()).has_value();
}

}  // namespace pwlsim::circuit
