#include "circuit/signals.hpp"

#include <algorithm>
#include <unordered_set>

#include <fmt/format.h>

#include "base/names.hpp"
#include "elements/raw_system.hpp"

namespace pwlsim::circuit {
namespace {

/// The name of a column without case, blanks and the two ways to write a separator: equal ones are one signal.
std::string column_key(const std::string& column) {
  std::string key;
  for (char c : without_case(column)) {
    if (c != ' ' && c != '\t') key += c == ':' ? '.' : c;
  }
  return key;
}

class SignalList {
 public:
  SignalList(const FlatCircuit& circuit, const NameIndex& names, Reporter& reporter)
      : circuit_(circuit), names_(names), reporter_(reporter) {}

  std::vector<SignalSource> read() {
    if (circuit_.saves.empty()) add_all();
    for (const SaveRequest& request : circuit_.saves) add(request);
    return std::move(list_);
  }

  std::vector<SignalSource> read_probes() {
    for (const SaveRequest& request : circuit_.probes) {
      seen_.clear();  // every probe keeps its place
      add(request);
    }
    return std::move(list_);
  }

 private:
  void add(const SaveRequest& request) {
    switch (request.kind) {
      case SaveRequest::Kind::all:
        return add_all();
      case SaveRequest::Kind::voltage:
        return add_voltage(request);
      case SaveRequest::Kind::current:
        return add_current(request);
      case SaveRequest::Kind::raw:
        return add_raw(request);
    }
  }

  void add(SignalSource source) {
    if (seen_.insert(column_key(source.column)).second) list_.push_back(std::move(source));
  }

  void add_all() {
    for (std::size_t k = 0; k < circuit_.nodes().size(); ++k) {
      if (circuit_.hidden.hold(circuit_.nodes()[k].name) || is_unread(static_cast<model::NodeIndex>(k))) continue;
      add({fmt::format("v({})", circuit_.nodes()[k].name), static_cast<model::NodeIndex>(k), model::ground, -1, ' ', 0});
    }
    for (std::size_t k = 0; k < circuit_.instances.size(); ++k) {
      const elements::Instance& instance = circuit_.instances[k];
      if (instance.raw_system != nullptr) add_all_of(instance, static_cast<int>(k));
      if (instance.kind == nullptr || !instance.kind->saved_by_default || circuit_.hidden.hold(instance.name)) continue;
      if (std::any_of(instance.nodes.begin(), instance.nodes.end(), [&](model::NodeIndex node) { return is_unread(node); })) continue;
      add({fmt::format("i({})", instance.name), model::ground, model::ground, static_cast<int>(k), ' ', 0});
    }
  }

  [[nodiscard]] bool is_unread(model::NodeIndex node) const { return circuit_.unread_nodes.contains(node); }

  void add_all_of(const elements::Instance& instance, int element) {
    const elements::RawSystem& raw = *instance.raw_system;
    for (const auto& [quantity, count] : {std::pair('x', raw.states), std::pair('u', raw.ports), std::pair('y', raw.ports)})
      for (int k = 0; k < count; ++k)
        add({fmt::format("{}({},{})", quantity, instance.name, k + 1), model::ground, model::ground, element, quantity,
             static_cast<std::size_t>(k)});
  }

  void add_raw(const SaveRequest& request) {
    const int element = names_.element(request.first);
    const auto* raw = element < 0 ? nullptr : circuit_.instances[static_cast<std::size_t>(element)].raw_system.get();
    if (raw == nullptr) {
      if (element < 0 || circuit_.instances[static_cast<std::size_t>(element)].kind != nullptr)
        reporter_.error("E-unknown-element", request.first_span, fmt::format("unknown system '{}': it has no .lcs card", request.first));
      return;
    }
    const int count = request.quantity == 'x' ? raw->states : raw->ports;
    if (request.number < 1 || request.number > count) {
      reporter_.error("E-unknown-signal", request.second_span,
                      fmt::format("{} of {} count from 1 to {}", request.quantity, request.first, count));
      return;
    }
    add({request.column, model::ground, model::ground, element, request.quantity, static_cast<std::size_t>(request.number) - 1});
  }

  std::optional<model::NodeIndex> node(const std::string& name, const SourceSpan& span) {
    const auto found = names_.node(name);
    if (!found) reporter_.error("E-unknown-node", span, fmt::format("unknown node '{}'{}", name, suggestion(name, names_.node_names())));
    return found;
  }

  void add_voltage(const SaveRequest& request) {
    const auto p = node(request.first, request.first_span);
    const auto n = request.second.empty() ? model::ground : node(request.second, request.second_span);
    if (p && n) add({request.column, *p, *n, -1, ' ', 0});
  }

  void add_current(const SaveRequest& request) {
    const int element = names_.element(request.first);
    if (element < 0) {
      reporter_.error("E-unknown-element", request.first_span, unknown_element(request.first));
      return;
    }
    const elements::Kind* kind = circuit_.instances[static_cast<std::size_t>(element)].kind;
    if (kind != nullptr && !kind->has_current) {
      reporter_.error("E-unknown-signal", request.first_span, fmt::format("{} is a {} and has no current", request.first, kind->name));
      return;
    }
    add({request.column, model::ground, model::ground, element, ' ', 0});
  }

  std::string unknown_element(const std::string& name) const {
    if (names_.is_call(name)) return fmt::format("{} is a subcircuit; try the current of an element in it", name);
    return fmt::format("unknown element '{}'{}", name, suggestion(name, names_.element_names()));
  }

  const FlatCircuit& circuit_;
  const NameIndex& names_;
  Reporter& reporter_;
  std::vector<SignalSource> list_;
  std::unordered_set<std::string> seen_;
};

}  // namespace

std::vector<SignalSource> resolve_signals(const FlatCircuit& circuit, const NameIndex& names, Reporter& reporter) {
  return SignalList(circuit, names, reporter).read();
}

std::vector<SignalSource> resolve_probes(const FlatCircuit& circuit, const NameIndex& names, Reporter& reporter) {
  return SignalList(circuit, names, reporter).read_probes();
}

std::vector<SignalSource> resolve_drawn(const FlatCircuit& circuit, const NameIndex& names, const std::vector<SignalSource>& known) {
  std::vector<SignalSource> drawn;
  const auto add = [&](SignalSource source) {
    const auto is_same = [&](const SignalSource& other) { return other.is_same(source); };
    if (std::none_of(known.begin(), known.end(), is_same) && std::none_of(drawn.begin(), drawn.end(), is_same))
      drawn.push_back(std::move(source));
  };
  for (const std::string& name : circuit.drawn.nodes)
    if (const auto node = names.node(name); node && *node != model::ground)
      add({fmt::format("v({})", name), *node, model::ground, -1, ' ', 0});
  for (const std::string& name : circuit.drawn.elements) {
    const int element = names.element(name);
    if (element < 0) continue;
    const elements::Kind* kind = circuit.instances[static_cast<std::size_t>(element)].kind;
    if (kind != nullptr && kind->has_current) add({fmt::format("i({})", name), model::ground, model::ground, element, ' ', 0});
  }
  return drawn;
}

model::Signal signal_of(const SignalSource& source, const std::vector<elements::Emitted>& emitted) {
  if (source.element < 0) return {source.column, model::voltage_between(source.p, source.n)};
  const elements::Emitted& element = emitted[static_cast<std::size_t>(source.element)];
  if (source.quantity == 'x') return {source.column, element.raw.x[source.index]};
  if (source.quantity == 'u') return {source.column, element.raw.u[source.index]};
  if (source.quantity == 'y') return {source.column, element.raw.y[source.index]};
  return {source.column, element.current};
}

}  // namespace pwlsim::circuit
