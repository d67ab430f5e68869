#pragma once
/// Syntax trees as short text, so that a test can show the tree it expects.

#include <string>

#include "base/diagnostic.hpp"
#include "netlist/load.hpp"

namespace tree_text {

inline std::string text_of(const pwlsim::netlist::Expression& expression) {
  using Kind = pwlsim::netlist::Expression::Kind;
  const auto& arguments = expression.arguments;
  switch (expression.kind) {
    case Kind::number:
    case Kind::name:
      return expression.text;
    case Kind::unary:
      return "(" + expression.text + text_of(arguments.at(0)) + ")";
    case Kind::binary:
      return "(" + text_of(arguments.at(0)) + expression.text + text_of(arguments.at(1)) + ")";
    case Kind::conditional:
      return "(" + text_of(arguments.at(0)) + "?" + text_of(arguments.at(1)) + ":" + text_of(arguments.at(2)) + ")";
    case Kind::call:
      break;
  }
  std::string text = expression.text + "(";
  for (const auto& argument : arguments) {
    text += (&argument == &arguments.front() ? "" : ",") + text_of(argument);
  }
  return text + ")";
}

inline std::string text_of(const std::vector<pwlsim::netlist::Item>& items);

/// word; {expression}; "string"; name(items); [items]; name=value, or name= where the value is missing.
inline std::string text_of(const pwlsim::netlist::Item& item) {
  using Kind = pwlsim::netlist::Item::Kind;
  switch (item.kind) {
    case Kind::word:
      return item.text;
    case Kind::expression:
      return "{" + text_of(*item.expression) + "}";
    case Kind::string:
      return '"' + item.text + '"';
    case Kind::group:
      return item.text + "(" + text_of(item.items) + ")";
    case Kind::vector:
      return "[" + text_of(item.items) + "]";
    case Kind::assignment:
      break;
  }
  const std::string left = item.items.size() > 1 ? text_of(item.items[1]) : item.text;
  return left + "=" + (item.items.empty() ? "" : text_of(item.items[0]));
}

inline std::string text_of(const std::vector<pwlsim::netlist::Item>& items) {
  std::string text;
  for (const auto& item : items) {
    text += (text.empty() ? "" : " ") + text_of(item);
  }
  return text;
}

inline std::string text_of(const pwlsim::netlist::Card& card) { return card.name + (card.items.empty() ? "" : " ") + text_of(card.items); }

/// A deck read from text, with all that was said about it.
struct Read {
  pwlsim::SourceStore sources;
  pwlsim::Diagnostics diagnostics;
  pwlsim::netlist::Deck deck;

  explicit Read(const std::string& text, const pwlsim::netlist::LoadLimits& limits = {}) {
    deck = pwlsim::netlist::parse("deck.net", text, sources, diagnostics, limits);
  }

  /// All cards, each on a line.
  [[nodiscard]] std::string cards() const {
    std::string text;
    for (const auto& card : deck.cards) {
      text += text_of(card) + "\n";
    }
    return text;
  }

  /// "id «underlined text»" of every message, each on a line.
  [[nodiscard]] std::string messages() const {
    std::string text;
    for (const auto& diagnostic : diagnostics.all()) {
      text += diagnostic.id + " «" + std::string(sources.text(diagnostic.span)) + "»\n";
    }
    return text;
  }
};

/// The tree of one card below a title line.
inline std::string card(const std::string& line) {
  const Read read("title\n" + line + "\n");
  return read.messages() + (read.deck.cards.size() == 1 ? text_of(read.deck.cards.front()) : read.cards());
}

/// The messages about one card below a title line.
inline std::string complaints(const std::string& line) { return Read("title\n" + line + "\n").messages(); }

}  // namespace tree_text
