#include "circuit/logic_device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/names.hpp"
#include "circuit/circuit.hpp"
#include "circuit/logic_subcircuit.hpp"
#include "netlist/number.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Item;
using ItemKind = Item::Kind;

/// Places of the terminals, from 0.
constexpr std::size_t input_places = 5, common = 7, device_nodes = 8;
constexpr std::string_view gate_parameters[] = {"vhigh", "vlow", "ref", "td"},
                           trip_parameters[] = {"vhigh", "vlow", "ref", "td", "vt", "vh"},
                           sample_parameters[] = {"vhigh", "vlow", "ref", "td"},
                           amplifier_parameters[] = {"vhigh", "vlow", "ref", "g", "iout", "isource", "isink", "rout", "cout"};
constexpr std::string_view ignored_parameters[] = {"trise", "tfall", "tau",    "cout",   "rout", "rhigh",
                                                   "rlow",  "ic",    "tripdt", "tripdv", "temp"};
/// Noise of an OTA, and the curves by which it saturates.
constexpr std::string_view ignored_of_amplifiers[] = {"en", "enk", "in", "ink", "incm", "incmk", "rclamp", "epsilon"};

struct DeviceUsage {
  std::span<const std::string_view> parameters;
  std::string_view text;
};

DeviceUsage usage_of(Logic logic) {
  if (logic == Logic::schmitt) return {trip_parameters, "Vhigh= Vlow= Ref= Td= Vt= Vh="};
  if (logic == Logic::sample_hold) return {sample_parameters, "Vhigh= Vlow= Ref= Td="};
  if (logic == Logic::transconductance) return {amplifier_parameters, "G= Vhigh= Vlow= Ref= Iout= Isource= Isink= Rout= Cout= linear"};
  return {gate_parameters, "Vhigh= Vlow= Ref= Td="};
}

class Replacement {
 public:
  Replacement(const Card& card, Reporter& reporter) : card_(card), reporter_(reporter) {}

  /// Eight words for nodes, and one for the type.
  [[nodiscard]] bool applies() const {
    if (!is_possible() || card_.items.size() <= device_nodes) return false;
    return std::all_of(card_.items.begin(), card_.items.begin() + device_nodes + 1,
                       [](const Item& item) { return item.kind == ItemKind::word && item.text.front() != '%'; });
  }

  /// With too few nodes; then it has been told.
  bool lacks_nodes() {
    constexpr std::size_t most_of_blocks = 4;  ///< words of an XSPICE block before its model
    for (std::size_t k = most_of_blocks; is_possible() && k < std::min(device_nodes, card_.items.size()); ++k) {
      const Item& item = card_.items[k];
      if (item.kind != ItemKind::word || find_logic_type(item.text) == nullptr) continue;
      if (k + 1 < card_.items.size() && card_.items[k + 1].kind == ItemKind::word) continue;
      const auto is_block = [](const Item& before) { return before.kind != ItemKind::word || before.text.front() == '%'; };
      if (std::any_of(card_.items.begin(), card_.items.begin() + static_cast<std::ptrdiff_t>(k), is_block)) continue;
      reporter_.error("E-missing-node", item.span,
                      fmt::format("{} gives {} nodes before {}; LTspice's devices have {}: five inputs, complement, output, common",
                                  card_.name, k, item.text, device_nodes));
      return true;
    }
    return false;
  }

  /// False after an error.
  bool make(Card& call) {
    const Item& type = card_.items[device_nodes];
    call = card_;
    device_.type = find_logic_type(type.text);
    if (device_.type == nullptr) {
      reporter_.error(
          "E-not-supported", type.span,
          fmt::format("{} is LTspice's own device {}, which is not supported; try one of BUF INV AND OR XOR SCHMITT DIFFSCHMITT SRFLOP "
                      "DFLOP SAMPLEHOLD OTA, "
                      "or a subcircuit of sources B with u() and if(), and of switches with hysteresis, which keep their positions",
                      card_.name, type.text));
      return false;
    }
    call.items.clear();
    call.made_call = true;
    if (!terminals(call) || !parameters(call)) return false;
    Item name = type;
    name.text = device_.name();
    call.items.insert(call.items.begin() + static_cast<std::ptrdiff_t>(nodes_), std::move(name));
    note_idealisation(type);
    return true;
  }

 private:
  void note_idealisation(const Item& type) {
    if (device_.type->logic == Logic::sample_hold) {
      if (reporter_.first_time("LTspice's samplehold"))
        reporter_.note("N-idealised", type.span,
                       "LTspice's sample-and-hold is idealised: it acquires the input in zero time, holds it without loss and has no "
                       "output resistance");
    } else if (device_.type->logic == Logic::transconductance) {
      if (device_.has_part('i') && reporter_.first_time("LTspice's ota"))
        reporter_.note("N-idealised", type.span,
                       "LTspice's OTA is idealised: its current is G times its input up to Iout, with corners where LTspice has a curve");
    } else if (reporter_.first_time("LTspice's logic")) {
      reporter_.note(
          "N-idealised", type.span,
          "LTspice's gates and flip-flops are idealised: levels Vlow and Vhigh without resistance or edges, an input is high above Ref, "
          "and a flip-flop starts with Q low");
    }
  }

  [[nodiscard]] bool is_possible() const { return lower_letter(card_.name.front()) == 'a' && !card_.damaged; }

  /// Unused ones are tied to the common.
  [[nodiscard]] bool is_used(std::size_t place) const {
    const std::string& node = card_.items[place].text;
    const std::string& ground = card_.items[common].text;
    return !same_name(node, ground) && !(is_ground_name(node) && is_ground_name(ground));
  }

  bool fail(const std::string& what) {
    reporter_.error("E-not-supported", card_.items[device_nodes].span, fmt::format("{} {}", card_.name, what));
    return false;
  }

  bool terminals(Card& call) {
    for (std::size_t k = 0; k < common; ++k) {
      if (!is_used(k)) continue;
      const char digit = static_cast<char>('1' + k);
      if (k < input_places && device_.type->inputs.find(digit) == std::string_view::npos)
        return fail(fmt::format("uses input {} of LTspice's {}, which has no meaning known here; try the common there", digit,
                                card_.items[device_nodes].text));
      (k < input_places ? device_.used : device_.outputs) += digit;
      call.items.push_back(card_.items[k]);
    }
    call.items.push_back(card_.items[common]);
    nodes_ = call.items.size();
    if (device_.used.size() < device_.type->least || device_.used.size() > device_.type->most)
      return fail(fmt::format("gives {} inputs to LTspice's {}; inputs at the common do not count", device_.used.size(),
                              card_.items[device_nodes].text));
    if (device_.type->logic == Logic::inverter && device_.outputs.size() > 1)
      return fail("uses both outputs of LTspice's INV; try BUF, whose first output is the complement");
    const bool has_one_output = device_.type->logic == Logic::sample_hold || device_.type->logic == Logic::transconductance;
    if (has_one_output && device_.outputs != "7")
      return fail(fmt::format("connects LTspice's {} by other nodes than its output, the seventh", card_.items[device_nodes].text));
    if (device_.type->logic == Logic::sample_hold && !device_.uses('3') && !device_.uses('4'))
      return fail("has neither a clock, the third node, nor S/H, the fourth");
    return true;
  }

  bool parameters(Card& call) {
    const DeviceUsage usage = usage_of(device_.type->logic);
    const bool is_amplifier = device_.type->logic == Logic::transconductance;
    bool is_linear = false;
    for (std::size_t k = device_nodes + 1; k < card_.items.size(); ++k) {
      const Item& item = card_.items[k];
      const auto is_same = [&](const Item& other) { return other.kind == item.kind && same_name(other.text, item.text); };
      if (item.kind == ItemKind::assignment &&
          std::any_of(card_.items.begin() + device_nodes, card_.items.begin() + static_cast<std::ptrdiff_t>(k), is_same)) {
        reporter_.error("E-duplicate-parameter", item.span, fmt::format("{} of {} is given twice", item.text, card_.name));
        return false;
      }
      if (item.kind == ItemKind::assignment && is_one_of(usage.parameters, item.text)) {
        device_.is_late |= same_name(item.text, "td");
        call.items.push_back(item);
      } else if (is_amplifier && item.kind == ItemKind::word && same_name(item.text, "linear")) {
        is_linear = true;
      } else if (item.kind == ItemKind::assignment &&
                 (is_one_of(ignored_parameters, item.text) || (is_amplifier && is_one_of(ignored_of_amplifiers, item.text)))) {
        if (reporter_.first_time("ignored of gates:" + without_case(item.text)))
          reporter_.warning("W-ignored-parameter", item.span,
                            fmt::format("{}= of LTspice's {} is ignored", item.text,
                                        is_amplifier                                ? "OTA"
                                        : device_.type->logic == Logic::sample_hold ? "SAMPLEHOLD"
                                                                                    : "gates"));
      } else {
        reporter_.error(
            "E-unknown-parameter", item.span,
            fmt::format("LTspice's {} takes {}, not '{}'", card_.items[device_nodes].text, usage.text, reporter_.text(item.span)));
        return false;
      }
    }
    if (device_.type->logic == Logic::sample_hold && device_.is_late && device_.uses('4'))
      return fail(
          "delays by Td= what S/H, the fourth node, lets through: a delay of a signal that moves has no piecewise-linear form; try Td=0");
    return !is_amplifier || amplifier(is_linear);
  }

  /// What an OTA has, and whether it has enough.
  bool amplifier(bool is_linear) {
    const auto given = [&](std::string_view name) -> const Item* {
      const auto found = std::find_if(card_.items.begin() + device_nodes, card_.items.end(), [&](const Item& item) {
        return item.kind == ItemKind::assignment && same_name(item.text, name) && !item.items.empty();
      });
      return found == card_.items.end() ? nullptr : &*found;
    };
    const bool has_limit = given("iout") != nullptr || (given("isource") != nullptr && given("isink") != nullptr);
    if (given("g") == nullptr || given("vhigh") == nullptr || given("vlow") == nullptr || (!is_linear && !has_limit)) {
      reporter_.error("E-missing-value", card_.items[device_nodes].span,
                      fmt::format("{} needs G=, Vhigh=, Vlow= (1e308 and -1e308 for no clamp), and Iout= or the word linear", card_.name));
      return false;
    }
    if (given("ref") != nullptr && (device_.uses('3') || device_.uses('4')))
      return fail(
          "has Ref= beside a second pair of inputs: to which of the two LTspice adds it is not documented; try a source in series with an "
          "input");
    if (given("rout") != nullptr) device_.parts += 'r';
    if (given("cout") != nullptr) device_.parts += 'c';
    if (is_bound(*given("vhigh"))) device_.parts += 'h';
    if (is_bound(*given("vlow"))) device_.parts += 'l';
    if (!is_linear) device_.parts += 'i';
    return true;
  }

  /// A number that no voltage reaches is none.
  static bool is_bound(const Item& assignment) {
    constexpr double beyond = 1e100;
    const netlist::NumberText number = netlist::read_number(assignment.items[0].text);
    return assignment.items[0].kind != ItemKind::word || !number.valid || std::abs(number.value) < beyond;
  }

  const Card& card_;
  Reporter& reporter_;
  LogicDevice device_;
  std::size_t nodes_ = 0;
};

}  // namespace

void replace_logic_devices(Definitions& definitions, Reporter& reporter) {
  for (const auto& definition : definitions.all)
    for (const Card*& card : definition->elements) {
      Replacement replacement(*card, reporter);
      const bool lacks_nodes = replacement.lacks_nodes();
      if (!lacks_nodes && !replacement.applies()) continue;
      Card call;
      if (lacks_nodes || !replacement.make(call)) {
        call = *card;
        call.damaged = true;  // it has been told what is wrong with it
      }
      card = &definitions.made.emplace_back(std::move(call));
    }
}

bool must_not_be_negative(std::string_view parameter) { return same_name(parameter, "td") || same_name(parameter, "vh"); }

}  // namespace pwlsim::circuit
