#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/commands.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Item;
using ItemKind = Item::Kind;

constexpr std::string_view usage = "v(node), v(node,node), i(element), x(system,1), u(system,1), y(system,1), or all";

bool is_word(const Item& item, std::string_view text) { return item.kind == ItemKind::word && same_name(item.text, text); }

bool holds_words(const Item& group, std::size_t least, std::size_t most) {
  if (group.items.size() < least || group.items.size() > most) return false;
  for (const Item& item : group.items) {
    if (item.kind != ItemKind::word) return false;
  }
  return true;
}

/// x(name,1), u(name,1), y(name,1)
bool is_raw_signal(const Item& item) {
  if (item.kind != ItemKind::group || !(same_name(item.text, "x") || same_name(item.text, "u") || same_name(item.text, "y"))) return false;
  if (!holds_words(item, 2, 2)) return false;
  const std::string& number = item.items[1].text;
  return number.size() <= 6 && std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// As the deck spells it, unless it runs over a line.
std::string column_name(const Item& group, const Reporter& reporter) {
  const std::string_view text = reporter.text(group.span);
  if (text.find('\n') == std::string_view::npos) return std::string(text);
  std::string name = group.text + "(" + group.items[0].text;
  if (group.items.size() > 1) name += "," + group.items[1].text;
  return name + ")";
}

void read_save(const Item& item, Reporter& reporter, std::vector<SaveRequest>& saves) {
  SaveRequest request;
  if (is_word(item, "all")) {
    request.kind = SaveRequest::Kind::all;
  } else if (item.kind == ItemKind::group && same_name(item.text, "v") && holds_words(item, 1, 2)) {
    request.kind = SaveRequest::Kind::voltage;
  } else if (item.kind == ItemKind::group && same_name(item.text, "i") && holds_words(item, 1, 1)) {
    request.kind = SaveRequest::Kind::current;
  } else if (is_raw_signal(item)) {
    request.kind = SaveRequest::Kind::raw;
    request.quantity = lower_letter(item.text[0]);
    request.number = std::stoi(item.items[1].text);
  } else {
    const std::string cure = item.kind == ItemKind::word ? fmt::format("; try v({})", item.text) : "";
    reporter.error("E-unknown-signal", item.span, fmt::format("'{}' is no signal: they are {}{}", reporter.text(item.span), usage, cure));
    return;
  }
  if (request.kind != SaveRequest::Kind::all) {
    request.column = column_name(item, reporter);
    request.first = item.items[0].text;
    request.first_span = item.items[0].span;
    if (item.items.size() > 1) request.second = item.items[1].text;
    if (item.items.size() > 1) request.second_span = item.items[1].span;
  }
  saves.push_back(std::move(request));
}

}  // namespace

void read_saves(const Definitions& definitions, Reporter& reporter, Circuit& circuit) {
  for (const Card* card : definitions.saves) {
    const bool print = same_name(card->name, ".print");
    if (card->items.empty() && same_name(card->name, ".save") && !card->damaged) {
      reporter.error("E-missing-value", card->span, fmt::format(".save names no signal; they are {}", usage));
    }
    for (const Item& item : card->items) {
      const bool analysis_name = print && &item == &card->items[0] && is_word(item, "tran");
      if (!analysis_name && !is_word(item, "time")) read_save(item, reporter, circuit.saves);
    }
  }
}

}  // namespace pwlsim::circuit
