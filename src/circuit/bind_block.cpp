#include "circuit/bind_block.hpp"

#include <fmt/format.h>

#include "base/names.hpp"
#include "elements/block.hpp"

namespace pwlsim::circuit {
namespace {

using elements::BlockInput;
using netlist::Item;
using ItemKind = Item::Kind;

struct PortKind {
  std::string_view name;
  bool is_current = false;
  std::size_t words = 1;
};
constexpr PortKind port_kinds[] = {{"%v"}, {"%vd", false, 2}, {"%i", true}, {"%id", true, 2}, {"%vnam", true}};

class BlockBinding {
 public:
  BlockBinding(Binding& binding, Place& place, CardCursor& cursor, const netlist::Card& card, elements::Instance& instance)
      : binding_(binding), place_(place), cursor_(cursor), card_(card), instance_(instance) {}

  bool bind() {
    if (!is_foreign() && port(cursor_, instance_.inputs, true) && output() && model()) return check_inputs();
    binding_.leave_gap();
    return false;
  }

 private:
  /// A block of a type that is not known here has ports that are not known either: its type is the error.
  bool is_foreign() {
    const netlist::Item* last = nullptr;
    for (const netlist::Item& item : card_.items)
      if (item.kind == ItemKind::word) last = &item;
    return last != nullptr && Models::known(place_.scope, *last) && binding_.models().use(place_.scope, *last, *instance_.kind) < 0;
  }

  Reporter& reporter() { return binding_.reporter(); }

  bool fail(std::string id, SourceSpan span, std::string_view what) {
    reporter().error(std::move(id), span, fmt::format("{}; usage: {}", what, instance_.kind->usage));
    return false;
  }

  bool missing(std::string_view what) { return fail("E-missing-node", card_.span, fmt::format("{} needs {}", card_.name, what)); }

  /// One port, or with `may_be_vector` any number between [ and ].
  bool port(CardCursor& cursor, std::vector<BlockInput>& ports, bool may_be_vector) {
    const PortKind* kind = port_kind(cursor);
    if (kind == nullptr) return false;
    if (may_be_vector && cursor.at(ItemKind::vector)) return vector(*cursor.next(), *kind, ports);
    return one_port(cursor, *kind, ports);
  }

  /// The kind a %word announces, else `otherwise`. `%vd(p,n)` is a group whose words follow.
  const PortKind* port_kind(CardCursor& cursor) {
    const Item* item = cursor.peek();
    if (item == nullptr || item->text.empty() || item->text[0] != '%') return &port_kinds[0];
    for (const PortKind& kind : port_kinds) {
      if (!same_name(kind.name, item->text)) continue;
      if (item->kind == ItemKind::word) cursor.next();
      return &kind;
    }
    fail("E-port-type", item->text_span, fmt::format("'{}' is not a port type; port types are %v %vd %i %id %vnam", item->text));
    return nullptr;
  }

  bool vector(const Item& list, const PortKind& kind, std::vector<BlockInput>& ports) {
    CardCursor inner(list.items);
    while (!inner.at_end()) {
      const PortKind* own = inner.peek()->text.starts_with('%') ? port_kind(inner) : &kind;
      if (own == nullptr || !one_port(inner, *own, ports)) return false;
    }
    return !ports.empty() || missing("an input between [ and ]");
  }

  bool one_port(CardCursor& cursor, const PortKind& kind, std::vector<BlockInput>& ports) {
    if (cursor.at(ItemKind::group)) {
      CardCursor inner(cursor.next()->items);
      return words(inner, kind, ports) && (inner.at_end() || missing(kind.words == 2 ? "two nodes for a port" : "a node for a port"));
    }
    return words(cursor, kind, ports);
  }

  bool words(CardCursor& cursor, const PortKind& kind, std::vector<BlockInput>& ports) {
    for (std::size_t k = 0; k < kind.words; ++k)
      if (!cursor.at(ItemKind::word, k)) return missing(kind.words == 2 ? "two nodes for a port" : "a node for a port");
    BlockInput port;
    port.is_current = kind.is_current;
    const Item& first = *cursor.next();
    if (kind.name == "%vnam") {
      port.reference = static_cast<int>(instance_.references.size());
      instance_.references.push_back({place_.prefix + first.text, first.span, -1});
    } else {
      port.nodes.p = binding_.node(place_, first);
      if (kind.words == 2) port.nodes.n = binding_.node(place_, *cursor.next());
    }
    ports.push_back(port);
    return true;
  }

  bool output() {
    std::vector<BlockInput> ports;
    if (!port(cursor_, ports, false)) return false;
    const BlockInput& port = ports[0];
    if (port.reference >= 0) return fail("E-port-type", card_.span, "%vnam is for inputs");
    instance_.formula_is_current = port.is_current;
    instance_.nodes = {port.nodes.p, port.nodes.n};
    return true;
  }

  bool model() {
    if (!cursor_.at(ItemKind::word)) return fail("E-missing-model", card_.span, fmt::format("{} needs a model", card_.name));
    instance_.model = binding_.models().use(place_.scope, *cursor_.next(), *instance_.kind);
    return instance_.model >= 0;
  }

  bool check_inputs() {
    const elements::Model& model = binding_.models().at(instance_.model);
    for (const BlockInput& input : instance_.inputs)
      if (!input.is_current) instance_.control_nodes.push_back(input.nodes);
    if (model.kind->block->takes_vector) return check_lists(model);
    if (instance_.inputs.size() == 1) return true;
    return fail("E-node-count", card_.span,
                fmt::format("{} gives {} inputs, but a block of type {} has one", card_.name, instance_.inputs.size(), model.kind->type));
  }

  /// A list of the model has one member for each input, or one for all.
  bool check_lists(const elements::Model& model) {
    for (const auto& given : model.values.all()) {
      if (given.list.size() == 1 || given.list.size() == instance_.inputs.size()) continue;
      return fail("E-node-count", card_.span,
                  fmt::format("{} gives {} inputs, but {} of {} has {} members", card_.name, instance_.inputs.size(), given.parameter->name,
                              model.name, given.list.size()));
    }
    return true;
  }

  Binding& binding_;
  Place& place_;
  CardCursor& cursor_;
  const netlist::Card& card_;
  elements::Instance& instance_;
};

}  // namespace

bool bind_block(Binding& binding, Place& place, CardCursor& cursor, const netlist::Card& card, elements::Instance& instance) {
  return BlockBinding(binding, place, cursor, card, instance).bind();
}

}  // namespace pwlsim::circuit
