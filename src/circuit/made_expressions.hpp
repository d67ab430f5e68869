#pragma once
/// Expressions that readers generate from other items of a card.

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "netlist/ast.hpp"
#include "netlist/number.hpp"

namespace pwlsim::circuit::make {

[[nodiscard]] inline netlist::Expression number(double value, SourceSpan span = {}) {
  return {netlist::Expression::Kind::number, value, {}, {}, span};
}
[[nodiscard]] inline netlist::Expression name(std::string_view text, SourceSpan span = {}) {
  return {netlist::Expression::Kind::name, 0.0, std::string(text), {}, span};
}
[[nodiscard]] inline netlist::Expression operation(netlist::Expression a, std::string_view sign, netlist::Expression b,
                                                   SourceSpan span = {}) {
  return {netlist::Expression::Kind::binary, 0.0, std::string(sign), {std::move(a), std::move(b)}, span};
}
[[nodiscard]] inline netlist::Expression call(std::string_view function, std::vector<netlist::Expression> arguments, SourceSpan span = {}) {
  return {netlist::Expression::Kind::call, 0.0, std::string(function), std::move(arguments), span};
}
/// v(p,n) of the nodes that two words name.
[[nodiscard]] inline netlist::Expression voltage_between(const netlist::Item& p, const netlist::Item& n, SourceSpan span) {
  return call("v", {name(p.text, p.span), name(n.text, n.span)}, span);
}
/// i(element)
[[nodiscard]] inline netlist::Expression current_through(const netlist::Item& element) {
  return call("i", {name(element.text, element.span)}, element.span);
}
/// Of an item that holds a number, a name or an expression.
[[nodiscard]] inline netlist::Expression value(const netlist::Item& item) {
  if (item.expression) return *item.expression;
  const netlist::NumberText text = netlist::read_number(item.text);
  return text.valid ? number(text.value) : name(item.text, item.span);
}
[[nodiscard]] inline netlist::Item item(netlist::Expression value, SourceSpan span) {
  netlist::Item made;
  made.kind = netlist::Item::Kind::expression;
  made.span = made.text_span = span;
  made.expression = std::make_shared<const netlist::Expression>(std::move(value));
  return made;
}

}  // namespace pwlsim::circuit::make
