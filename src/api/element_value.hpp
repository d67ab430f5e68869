#pragma once
/// Where the value of an element stands on its card: what `Circuit::set_value` replaces and `Circuit::value` reads.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "elements/kind.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::api {

/// The element's card of that name, outside of subcircuits; the last one. Null: there is none.
[[nodiscard]] netlist::Card* find_card(std::vector<netlist::Card>& cards, std::string_view name);

/// Whether a `.param` outside of subcircuits defines it.
[[nodiscard]] bool has_parameter(const std::vector<netlist::Card>& cards, std::string_view name);

/// Items [first, last) of a card.
struct ValuePlace {
  std::size_t first = 0, last = 0;
};
/// R, C, L: the number behind the nodes, or `R=` and its like; V, I: all up to AC or an assignment; E, F, G, H: the gain; K: the coefficient.
/// Empty for other kinds, and where a formula or the name of a model stands there.
[[nodiscard]] std::optional<ValuePlace> place_of_value(const netlist::Card& card);

/// The card up to its value, as text of which only the number of words counts.
[[nodiscard]] std::string head_of_value(const netlist::Card& card, const ValuePlace& place);
/// `parsed`: that head with the new value behind it.
void replace_value(netlist::Card& card, const ValuePlace& place, const netlist::Card& parsed);

/// What that value is once parameters have been evaluated: ohm, farad, henry, V or A of a constant source, a gain, a coefficient. Empty: none.
[[nodiscard]] std::optional<double> value_of(const elements::Instance& instance);

}  // namespace pwlsim::api
