#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/card_items.hpp"
#include "circuit/commands.hpp"
#include "circuit/output_expression.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Item;
using ItemKind = Item::Kind;

constexpr std::string_view signal_usage = "v(node), v(node,node), i(element), x(system,1), u(system,1), y(system,1), or all";

bool holds_words(const Item& group, std::size_t least, std::size_t most) {
  if (group.items.size() < least || group.items.size() > most) return false;
  for (const Item& item : group.items) {
    if (item.kind != ItemKind::word) return false;
  }
  return true;
}

bool is_whole_number(std::string_view text) {
  return !text.empty() && text.size() <= 6 && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// x(name,1), u(name,1), y(name,1)
bool is_raw_signal(const Item& item) {
  if (item.kind != ItemKind::group || !(same_name(item.text, "x") || same_name(item.text, "u") || same_name(item.text, "y"))) return false;
  if (!holds_words(item, 2, 2)) return false;
  return is_whole_number(item.items[1].text);
}

/// PSpice's v([a],[b]): the nodes without their brackets.
Item without_brackets(Item group) {
  for (Item& item : group.items)
    if (item.kind == ItemKind::vector && item.items.size() == 1) item = Item(item.items[0]);
  return group;
}

/// As the deck spells it, unless it runs over a line.
std::string column_name(const Item& group, const Reporter& reporter) {
  const std::string_view text = reporter.text(group.span);
  if (text.find('\n') == std::string_view::npos) return std::string(text);
  std::string name = group.text + "(" + group.items[0].text;
  if (group.items.size() > 1) name += "," + group.items[1].text;
  return name + ")";
}

/// `*`, or alias(*).
bool holds_star(const Item& item) {
  if (item.kind == ItemKind::word) return item.text == "*";
  return item.kind == ItemKind::group && item.items.size() == 1 && holds_star(item.items[0]);
}

/// v(*), i(alias(*)) and the like on PSpice's .probe, and ngspice's alli.
bool is_everything(const Item& item) { return is_word(item, "all") || is_word(item, "alli") || holds_star(item); }

/// Id(M1), Id(J1), Ic(Q1): the currents into first nodes, as LTspice names them.
bool names_transistor_current(std::string_view quantity, char letter) {
  return same_name(quantity, "id") ? letter == 'm' || letter == 'j' : same_name(quantity, "ic") && letter == 'q';
}

bool is_transistor_item(const Item& item) {
  return item.kind == ItemKind::group && holds_words(item, 1, 1) &&
         names_transistor_current(item.text, lower_letter(item.items[0].text.front()));
}

/// Powers, expressions and options of columns, which other simulators print: a word may be a slip instead.
bool is_other_output(const Item& item) {
  const bool is_voltage_or_current = same_name(item.text, "v") || same_name(item.text, "i");
  return item.kind == ItemKind::assignment || item.kind == ItemKind::expression ||
         (item.kind == ItemKind::group && !is_voltage_or_current) || (item.kind == ItemKind::word && item.text.starts_with('@'));
}

/// ngspice's @d1[id], @r1[i], @q1[ic]: the element; empty for another word.
std::string_view device_of(std::string_view word) {
  const std::size_t bracket = word.find('[');
  if (!word.starts_with('@') || bracket == std::string_view::npos || bracket < 2) return {};
  const std::string_view quantity = word.substr(bracket);
  const char letter = lower_letter(word[1]);
  const bool is_current = same_name(quantity, "[i]") || (same_name(quantity, "[ic]") && letter == 'q') ||
                          (same_name(quantity, "[id]") && (letter == 'd' || letter == 'm' || letter == 'j'));
  return is_current ? word.substr(1, bracket - 1) : std::string_view{};
}

}  // namespace

std::optional<SaveRequest> save_request(const Item& item, Reporter& reporter) {
  SaveRequest request;
  if (is_everything(item)) {
    request.kind = SaveRequest::Kind::all;
  } else if (const std::string_view device = item.kind == ItemKind::word ? device_of(item.text) : ""; !device.empty()) {
    request.kind = SaveRequest::Kind::current;
    request.column = item.text;
    request.first = device;
    request.first_span = item.span;
    return request;
  } else if (item.kind == ItemKind::group && same_name(item.text, "v") && holds_words(item, 1, 2)) {
    request.kind = SaveRequest::Kind::voltage;
  } else if (item.kind == ItemKind::group && same_name(item.text, "i") && holds_words(item, 1, 1)) {
    request.kind = SaveRequest::Kind::current;
  } else if (is_transistor_item(item)) {
    request.kind = SaveRequest::Kind::current;
  } else if (is_raw_signal(item)) {
    request.kind = SaveRequest::Kind::raw;
    request.quantity = lower_letter(item.text[0]);
    request.number = std::stoi(item.items[1].text);
  } else if (is_other_output(item)) {
    reporter.warning("W-ignored-output", item.span,
                     fmt::format("'{}' is left out: only {} are saved; .meas takes expressions", reporter.text(item.span), signal_usage));
    return std::nullopt;
  } else {
    const std::string cure = item.kind == ItemKind::word ? fmt::format("; try v({})", item.text) : "";
    reporter.error("E-unknown-signal", item.span,
                   fmt::format("'{}' is not a signal; signals are {}{}", reporter.text(item.span), signal_usage, cure));
    return std::nullopt;
  }
  if (request.kind != SaveRequest::Kind::all) {
    request.column = column_name(item, reporter);
    request.first = item.items[0].text;
    request.first_span = item.items[0].span;
    if (item.items.size() > 1) request.second = item.items[1].text;
    if (item.items.size() > 1) request.second_span = item.items[1].span;
  }
  return request;
}

bool is_transistor_current(const netlist::Expression& call) {
  if (call.arguments.size() != 1 || call.arguments[0].text.empty()) return false;
  return names_transistor_current(call.text, lower_letter(call.arguments[0].text.front()));
}

std::optional<SaveRequest> signal_request(const netlist::Expression& call, Reporter& reporter) {
  SaveRequest request;
  const std::size_t count = call.arguments.size();
  const bool is_voltage = same_name(call.text, "v");
  const bool is_current = same_name(call.text, "i") || is_transistor_current(call);
  const bool is_raw = !is_voltage && !is_current;
  const bool fits = is_voltage ? count == 1 || count == 2 : is_current ? count == 1 : count == 2 && is_whole_number(call.arguments[1].text);
  if (!fits) {
    reporter.error("E-unknown-signal", call.span,
                   fmt::format("'{}' is not a signal; signals are {}", reporter.text(call.span), signal_usage));
    return std::nullopt;
  }
  request.kind = is_voltage ? SaveRequest::Kind::voltage : is_current ? SaveRequest::Kind::current : SaveRequest::Kind::raw;
  request.column = std::string(reporter.text(call.span));
  request.first = call.arguments[0].text;
  request.first_span = call.arguments[0].span;
  if (count > 1) request.second = call.arguments[1].text;
  if (count > 1) request.second_span = call.arguments[1].span;
  if (is_raw) {
    request.quantity = lower_letter(call.text[0]);
    request.number = std::stoi(request.second);
  }
  return request;
}

void read_saves(Definitions& definitions, Reporter& reporter, FlatCircuit& circuit) {
  for (const Card* card : definitions.saves) {
    const bool names_analysis = same_name(card->name, ".print") || same_name(card->name, ".probe");
    if (card->items.empty() && same_name(card->name, ".save") && !card->damaged) {
      reporter.error("E-missing-value", card->span, fmt::format(".save names no signal; they are {}", signal_usage));
    }
    for (const Item& item : card->items) {
      const bool analysis_name = names_analysis && &item == &card->items[0] && is_word(item, "tran");
      if (analysis_name || is_word(item, "time")) continue;
      if (is_word(item, "dialogbox")) {
        reporter.note("N-dialogbox", item.span,
                      "LTspice opens a dialog here: the signals named on other cards are saved, or all if there are none");
        continue;
      }
      const Item plain = without_brackets(item);
      std::optional<SaveRequest> request = output_expression(plain, definitions, reporter, circuit);
      if (!request) request = save_request(plain, reporter);
      if (request) circuit.saves.push_back(std::move(*request));
    }
  }
}

}  // namespace pwlsim::circuit
