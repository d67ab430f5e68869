#include "circuit/xspice_logic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <unordered_set>

#include "base/names.hpp"
#include "circuit/logic_subcircuit.hpp"
#include "circuit/made_expressions.hpp"
#include "circuit/models.hpp"
#include "circuit/xspice_oscillators.hpp"
#include "netlist/number.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Expression;
using netlist::Item;
using ItemKind = Item::Kind;

/// A block, and the device that stands for it.
struct LogicBlock {
  enum class Shape { into_bits, out_of_bits, single, gate, flip_flop, toggle, jk, latch, data_latch, contact, oscillator };
  std::string_view type;
  Shape shape;
  std::string_view device{};
  char output = '7';     ///< '6' where the device's complement is meant
  std::size_t most = 5;  ///< inputs
};
constexpr LogicBlock blocks[] = {
    {"adc_bridge", LogicBlock::Shape::into_bits, "schmitt"},
    {"dac_bridge", LogicBlock::Shape::out_of_bits, "buf"},
    {"d_buffer", LogicBlock::Shape::single, "buf"},
    {"d_inverter", LogicBlock::Shape::single, "buf", '6'},
    {"d_and", LogicBlock::Shape::gate, "and"},
    {"d_nand", LogicBlock::Shape::gate, "and", '6'},
    {"d_or", LogicBlock::Shape::gate, "or"},
    {"d_nor", LogicBlock::Shape::gate, "or", '6'},
    {"d_xor", LogicBlock::Shape::gate, "xor", '7', 2},
    {"d_xnor", LogicBlock::Shape::gate, "xor", '6', 2},
    {"d_dff", LogicBlock::Shape::flip_flop, "dflop"},
    {"d_tff", LogicBlock::Shape::toggle, "dflop"},
    {"d_jkff", LogicBlock::Shape::jk, "dflop"},
    {"d_srlatch", LogicBlock::Shape::latch, "srflop"},
    {"d_dlatch", LogicBlock::Shape::data_latch, "srflop"},
    {"aswitch", LogicBlock::Shape::contact, {}},
    {"triangle", LogicBlock::Shape::oscillator, {}},
    {"square", LogicBlock::Shape::oscillator, {}},
    {"sine", LogicBlock::Shape::oscillator, {}},
    {"d_osc", LogicBlock::Shape::oscillator, {}},
    {"d_pwm", LogicBlock::Shape::oscillator, {}},
};

/// What the model of a block may give, apart from what is read: loads, edges, the level of the unknown state.
constexpr std::string_view without_use[] = {"input_load",     "data_load", "clk_load", "set_load",    "reset_load", "t_rise",
                                            "t_fall",         "out_undef", "log",      "limit",       "family",     "t_load",
                                            "inertial_delay", "jk_load",   "sr_load",  "enable_load", "rise_time",  "fall_time"};

const LogicBlock* find_block(std::string_view type) {
  const auto* found =
      std::find_if(std::begin(blocks), std::end(blocks), [&](const LogicBlock& block) { return same_name(block.type, type); });
  return found == std::end(blocks) ? nullptr : found;
}

const Card* find_model_card(const Definition& from, std::string_view name) {
  const std::string key = without_case(name);
  for (const Definition* at = &from; at != nullptr; at = at->parent)
    if (const auto found = at->models.find(key); found != at->models.end()) return found->second;
  return nullptr;
}

Expression expression_of(const Item* item, double otherwise) { return item != nullptr ? make::value(*item) : make::number(otherwise); }

/// factor (a ± b)
Expression combined(double factor, const Expression& a, std::string_view sign, const Expression& b) {
  return make::operation(make::number(factor), "*", make::operation(a, sign, b));
}

Item assignment(std::string_view name, Expression value, SourceSpan span) {
  Item whole;
  whole.kind = ItemKind::assignment;
  whole.text = name;
  whole.span = whole.text_span = span;
  whole.items.push_back(make::item(std::move(value), span));
  return whole;
}

/// The nodes of one port: several between [ and ], two behind %vd or %gd.
struct XspicePort {
  std::vector<Item> nodes;
  bool is_current = false;
};

class XspiceReplacement {
 public:
  XspiceReplacement(const Definition& definition, const Card& card, Reporter& reporter)
      : definition_(definition), card_(card), reporter_(reporter) {}

  [[nodiscard]] bool applies() {
    if (lower_letter(card_.name.front()) != 'a' || card_.damaged || card_.items.size() < 3) return false;
    const Item& name = card_.items.back();
    const Card* model = name.kind == ItemKind::word ? find_model_card(definition_, name.text) : nullptr;
    if (model == nullptr) return false;
    Diagnostics unheard;
    Reporter scratch = reporter_.beside(unheard);
    text_ = read_model_text(*model, scratch);
    block_ = text_ ? find_block(text_->type) : nullptr;
    return block_ != nullptr;
  }

  /// Empty after an error.
  std::vector<Card> calls(std::unordered_set<std::string>& inverted) {
    read_ports();
    check_parameters();
    switch (block_->shape) {
      case LogicBlock::Shape::into_bits:
      case LogicBlock::Shape::out_of_bits:
        bridge();
        break;
      case LogicBlock::Shape::single:
      case LogicBlock::Shape::gate:
        gate(inverted);
        break;
      case LogicBlock::Shape::contact:
        contact();
        break;
      case LogicBlock::Shape::oscillator:
        oscillator();
        break;
      default:
        stateful(inverted);
    }
    if (!calls_.empty()) note_idealisation();
    return std::move(calls_);
  }

 private:
  [[nodiscard]] SourceSpan span() const { return card_.items.back().span; }

  void fail(std::string_view what) {
    calls_.clear();
    reporter_.error("E-missing-node", card_.span, fmt::format("{} {}", card_.name, what));
  }

  void read_ports() {
    for (std::size_t k = 0; k + 1 < card_.items.size(); ++k) {
      const Item& item = card_.items[k];
      const bool is_type = item.text.starts_with('%');
      const bool is_pair = same_name(item.text, "%vd") || same_name(item.text, "%gd") || same_name(item.text, "%hd");
      XspicePort port;
      port.is_current = is_type && lower_letter(item.text.c_str()[1]) == 'i';
      if (is_type && item.kind == ItemKind::word) {
        const std::size_t words = card_.items[k + 1].kind == ItemKind::word && is_pair ? 2 : 1;
        for (std::size_t n = 0; n < words && k + 2 < card_.items.size(); ++n) take(card_.items[++k], port);
      } else {
        take(item, port);
      }
      ports_.push_back(std::move(port));
    }
  }

  static void take(const Item& item, XspicePort& port) {
    if (item.kind == ItemKind::word) port.nodes.push_back(item);
    for (const Item& inner : item.items)
      if (inner.kind == ItemKind::word && !inner.text.starts_with('%')) port.nodes.push_back(inner);
  }

  [[nodiscard]] const Item* given(std::string_view name) const {
    for (const Item* item : text_->parameters)
      if (item->kind == ItemKind::assignment && same_name(item->text, name) && !item->items.empty()) return &item->items[0];
    return nullptr;
  }

  void check_parameters() {
    static constexpr std::string_view known[] = {"in_low", "in_high", "out_low",    "out_high",   "cntl_on",   "cntl_off",
                                                 "r_on",   "r_off",   "rise_delay", "fall_delay", "clk_delay", "ic"};
    static constexpr std::string_view known_to_oscillators[] = {"cntl_array", "freq_array", "dc_array",  "out_low",
                                                                "out_high",   "duty_cycle", "frequency", "init_phase"};
    const bool is_oscillator = block_->shape == LogicBlock::Shape::oscillator;
    for (const Item* item : text_->parameters) {
      if (item->kind != ItemKind::assignment || is_one_of(without_use, item->text)) continue;
      if (is_oscillator ? is_one_of(known_to_oscillators, item->text) : is_one_of(known, item->text)) continue;
      if (same_name(item->text, own_delay())) continue;
      reporter_.warning("W-ignored-parameter", item->text_span, fmt::format("{}= of XSPICE's {} is ignored", item->text, block_->type));
    }
    if (given("ic") != nullptr && expression_of(given("ic"), 0.0).number != 0.0)
      reporter_.warning("W-ignored-parameter", given("ic")->span,
                        fmt::format("ic= of XSPICE's {} is ignored: its output starts low", block_->type));
  }

  /// The subcircuit of a device, called with the nodes (inputs, outputs), ground and the assignments.
  void call(std::string_view part, const LogicDevice& device, std::vector<Item> nodes, std::vector<Item> assignments) {
    Card made = card_;
    made.made_call = true;
    made.name += part;
    made.items = std::move(nodes);
    made.items.push_back(word("0"));
    made.items.push_back(word(device.name()));
    for (Item& item : assignments) made.items.push_back(std::move(item));
    calls_.push_back(std::move(made));
  }

  [[nodiscard]] Item word(std::string text) const { return made_word(std::move(text), span()); }

  static LogicDevice device_of(std::string_view type, std::string used, std::string outputs) {
    LogicDevice device;
    device.type = find_logic_type(type);
    device.used = std::move(used);
    device.outputs = std::move(outputs);
    return device;
  }

  /// One delay counts for all of a device's inputs.
  [[nodiscard]] std::string_view own_delay() const {
    return block_->shape == LogicBlock::Shape::latch        ? "sr_delay"
           : block_->shape == LogicBlock::Shape::data_latch ? "data_delay"
           : same_name(block_->device, "dflop")             ? "clk_delay"
                                                            : "rise_delay";
  }

  /// Delays that the model gives; those that it does not are none.
  void add_delay(LogicDevice& device, std::vector<Item>& assignments) {
    const bool is_clocked = same_name(block_->device, "dflop");
    const Item *rise = given(own_delay()), *fall = given("fall_delay");
    const Item* delay = rise != nullptr ? rise : fall;
    if (delay == nullptr) return;
    if (!is_clocked && rise != nullptr && fall != nullptr && rise->text != fall->text)
      reporter_.warning("W-ignored-parameter", fall->span,
                        fmt::format("fall_delay= of XSPICE's {} is ignored: rise_delay applies to both edges", block_->type));
    device.is_late = true;
    assignments.push_back(assignment("td", expression_of(delay, 0.0), delay->span));
  }

  void bridge() {
    if (ports_.size() != 2 || ports_[0].nodes.size() != ports_[1].nodes.size() || ports_[0].nodes.empty() || ports_[0].is_current)
      return fail(fmt::format("needs as many outputs as inputs: [in ...] [out ...] {}", card_.items.back().text));
    for (std::size_t k = 0; k < ports_[0].nodes.size(); ++k) {
      Item in = ports_[0].nodes[k], out = ports_[1].nodes[k];
      const bool is_inverted = in.text.starts_with('~') != out.text.starts_with('~');
      for (Item* item : {&in, &out})
        if (item->text.starts_with('~')) item->text.erase(0, 1);
      LogicDevice device = device_of(block_->device, "1", is_inverted ? "6" : "7");
      std::vector<Item> assignments;
      if (block_->shape == LogicBlock::Shape::into_bits) {
        const Expression low = expression_of(given("in_low"), 1.0), high = expression_of(given("in_high"), 2.0);
        assignments.push_back(assignment("vt", combined(0.5, high, "+", low), span()));
        assignments.push_back(assignment("vh", combined(0.5, high, "-", low), span()));
      } else {
        assignments.push_back(assignment("vlow", expression_of(given("out_low"), 0.0), span()));
        assignments.push_back(assignment("vhigh", expression_of(given("out_high"), 1.0), span()));
        assignments.push_back(assignment("ref", make::number(0.5), span()));
      }
      add_delay(device, assignments);
      call(ports_[0].nodes.size() > 1 ? fmt::format("~{}", k + 1) : "", device, {in, out}, std::move(assignments));
    }
  }

  /// `~x` is the complement of x, which one inverter makes for all.
  Item input(const Item& item, std::unordered_set<std::string>& inverted) {
    if (item.text.starts_with('~') && inverted.insert(without_case(item.text)).second) {
      Item of = item;
      of.text.erase(0, 1);
      call(item.text, device_of("inv", "1", "7"), {of, item}, {});
    }
    return item;
  }

  void gate(std::unordered_set<std::string>& inverted) {
    const std::size_t count = ports_.empty() ? 0 : ports_[0].nodes.size();
    if (ports_.size() != 2 || ports_[1].nodes.size() != 1 || count == 0)
      return fail(fmt::format("needs an input and an output; usage: {} {} output {}", card_.name,
                              block_->shape == LogicBlock::Shape::single ? "input" : "[input ...]", card_.items.back().text));
    if (count > block_->most)
      return reporter_.error(
          "E-not-supported", card_.span,
          fmt::format("{} has {} inputs; a {} takes {} at most here; try a chain of gates", card_.name, count, block_->type, block_->most));
    std::vector<Item> nodes;
    std::string used;
    for (const Item& item : ports_[0].nodes) {
      nodes.push_back(input(item, inverted));
      used += static_cast<char>('1' + used.size());
    }
    Item out = ports_[1].nodes[0];
    bool is_complement = block_->output == '6';
    if (out.text.starts_with('~')) {
      out.text.erase(0, 1);
      is_complement = !is_complement;
    }
    nodes.push_back(out);
    LogicDevice device = device_of(count == 1 ? "buf" : block_->device, used, is_complement ? "6" : "7");
    std::vector<Item> assignments;
    add_delay(device, assignments);
    call("", device, std::move(nodes), std::move(assignments));
  }

  [[nodiscard]] static bool is_null(const Item& item) { return same_name(item.text, "null"); }

  /// So many nodes, each in a port of its own; those that are inputs may be complements.
  bool take_nodes(std::size_t inputs, std::string_view usage, std::unordered_set<std::string>& inverted) {
    const bool is_whole = ports_.size() == inputs + 2 &&
                          std::all_of(ports_.begin(), ports_.end(), [](const XspicePort& port) { return port.nodes.size() == 1; });
    if (!is_whole) {
      fail(fmt::format("needs {} nodes; usage: {} {} out Nout {}", inputs + 2, card_.name, usage, card_.items.back().text));
      return false;
    }
    for (std::size_t k = 0; k < ports_.size(); ++k) nodes_.push_back(k < inputs ? input(ports_[k].nodes[0], inverted) : ports_[k].nodes[0]);
    return true;
  }

  /// The output of a gate that stands for itself: an inner node.
  Item made_gate(std::string_view type, std::vector<Item> inputs, bool is_complement = false) {
    const std::string part = fmt::format("~{}", ++inner_);
    std::string used;
    for (std::size_t k = 0; k < inputs.size(); ++k) used += static_cast<char>('1' + k);
    Item out = word(card_.name + part);
    inputs.push_back(out);
    call(part, device_of(type, std::move(used), is_complement ? "6" : "7"), std::move(inputs), {});
    return out;
  }

  /// Those that are used alone count; none: null.
  Item either(const Item& a, const Item& b) {
    if (is_null(a)) return b;
    return is_null(b) ? a : made_gate("or", {a, b});
  }

  /// Unused outputs that the block itself needs get a node.
  Item needed_output(std::size_t k) {
    if (is_null(nodes_[k])) nodes_[k] = word(fmt::format("{}~q{}", card_.name, k));
    return nodes_[k];
  }

  /// A flip-flop: data, the clock, set and reset, then its outputs.
  void flip_flop(const Item& data, std::size_t clock) {
    constexpr std::array<char, 4> places{'1', '3', '4', '5'};
    std::vector<Item> inputs{data, nodes_[clock], nodes_[clock + 1], nodes_[clock + 2]}, used_nodes;
    std::string used;
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (is_null(inputs[k])) continue;
      used += places[k];
      used_nodes.push_back(inputs[k]);
    }
    finish(std::move(used), std::move(used_nodes), clock + 3);
  }

  void set_reset(const Item& set, const Item& reset, std::size_t out) {
    std::vector<Item> inputs;
    std::string used;
    for (const auto& [place, item] : {std::pair('1', set), std::pair('2', reset)}) {
      if (is_null(item)) continue;
      used += place;
      inputs.push_back(item);
    }
    if (used.empty()) return fail("has neither a set nor a reset");
    finish(std::move(used), std::move(inputs), out);
  }

  /// The device itself, with its outputs: the complement comes first.
  void finish(std::string used, std::vector<Item> inputs, std::size_t out) {
    std::string outputs;
    for (const auto& [place, k] : {std::pair('6', out + 1), std::pair('7', out)}) {
      if (is_null(nodes_[k])) continue;
      outputs += place;
      inputs.push_back(nodes_[k]);
    }
    LogicDevice device = device_of(block_->device, std::move(used), std::move(outputs));
    std::vector<Item> assignments;
    add_delay(device, assignments);
    call("", device, std::move(inputs), std::move(assignments));
  }

  void stateful(std::unordered_set<std::string>& inverted) {
    switch (block_->shape) {
      case LogicBlock::Shape::toggle:
        if (take_nodes(4, "t clk set reset", inverted)) flip_flop(made_gate("xor", {nodes_[0], needed_output(4)}), 1);
        return;
      case LogicBlock::Shape::jk:
        if (take_nodes(5, "j k clk set reset", inverted)) {
          const Item sets = made_gate("and", {nodes_[0], needed_output(6)});
          const Item keeps = made_gate("and", {made_gate("buf", {nodes_[1]}, true), needed_output(5)});
          flip_flop(made_gate("or", {sets, keeps}), 2);
        }
        return;
      case LogicBlock::Shape::latch:
        if (take_nodes(5, "s r enable set reset", inverted)) {
          const bool is_gated = !is_null(nodes_[2]);
          const auto gated = [&](const Item& item) { return is_gated && !is_null(item) ? made_gate("and", {item, nodes_[2]}) : item; };
          const Item set = either(gated(nodes_[0]), nodes_[3]), reset = either(gated(nodes_[1]), nodes_[4]);
          set_reset(set, reset, 5);
        }
        return;
      case LogicBlock::Shape::data_latch:
        if (take_nodes(4, "data enable set reset", inverted)) {
          const Item set = made_gate("and", {nodes_[0], nodes_[1]});
          const Item reset = made_gate("and", {made_gate("buf", {nodes_[0]}, true), nodes_[1]});
          set_reset(either(set, nodes_[2]), either(reset, nodes_[3]), 4);
        }
        return;
      default:
        if (take_nodes(4, "data clk set reset", inverted)) flip_flop(nodes_[0], 1);
    }
  }

  void contact() {
    if (ports_.size() == 3 && ports_[1].nodes.size() == 1 && ports_[2].nodes.size() == 1) {  // two words without %gd
      ports_[1].nodes.push_back(ports_[2].nodes[0]);
      ports_.pop_back();
    }
    if (ports_.size() != 2 || ports_[1].nodes.size() != 2 || ports_[0].nodes.empty() || ports_[0].is_current)
      return fail(fmt::format("needs a control and the two ends of the switch; usage: {} control %gd(a b) {}", card_.name,
                              card_.items.back().text));
    Card made = card_;
    made.made_call = true;
    made.items = ports_[0].nodes;
    if (made.items.size() == 1) made.items.push_back(word("0"));
    for (const Item& item : ports_[1].nodes) made.items.push_back(item);
    made.items.push_back(word(std::string(analog_switch)));
    for (const std::string_view name : {"cntl_off", "cntl_on", "r_off", "r_on"})
      if (const Item* item = given(name)) made.items.push_back(assignment(name, expression_of(item, 0.0), item->span));
    calls_.push_back(std::move(made));
  }

  /// A voltage controls it, and a voltage or a bit is what it gives.
  void oscillator() {
    const auto is_voltage = [](const XspicePort& port) { return !port.is_current && (port.nodes.size() == 1 || port.nodes.size() == 2); };
    if (ports_.size() != 2 || !is_voltage(ports_[0]) || !is_voltage(ports_[1]))
      return fail(fmt::format("needs the voltage that controls it and an output; usage: {} control output {}", card_.name,
                              card_.items.back().text));
    calls_.push_back(
        oscillator_card(card_, block_->type, ports_[0].nodes, ports_[1].nodes, [&](std::string_view name) { return given(name); }));
  }

  void note_idealisation() {
    if (block_->shape == LogicBlock::Shape::oscillator) return;
    if (block_->shape == LogicBlock::Shape::contact) {
      if (reporter_.first_time("XSPICE's switch"))
        reporter_.note("N-idealised", span(), "XSPICE's aswitch is idealised: it switches in the middle between cntl_off and cntl_on");
    } else if (reporter_.first_time("XSPICE's logic")) {
      reporter_.note(
          "N-idealised", span(),
          "XSPICE's digital blocks are idealised: bits are voltages of 0 and 1 V against ground, none is unknown, outputs have no edges, "
          "and delays are zero unless a model gives them");
    }
  }

  const Definition& definition_;
  const Card& card_;
  Reporter& reporter_;
  std::optional<ModelText> text_;
  const LogicBlock* block_ = nullptr;
  std::vector<XspicePort> ports_;
  std::vector<Item> nodes_;  ///< of blocks whose ports are one node each
  std::size_t inner_ = 0;    ///< gates made
  std::vector<Card> calls_;
};

}  // namespace

void replace_xspice_logic(Definitions& definitions, Reporter& reporter) {
  std::unordered_map<const Definition*, std::unordered_set<std::string>> inverted;
  replace_elements(definitions, [&](const Definition& definition, const Card& card) -> std::optional<std::vector<Card>> {
    XspiceReplacement replacement(definition, card, reporter);
    if (!replacement.applies()) return std::nullopt;
    return replacement.calls(inverted[&definition]);
  });
}

}  // namespace pwlsim::circuit
