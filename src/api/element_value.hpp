#pragma once
/// The place of an element's value on its card, which `Circuit::set_value` replaces and `Circuit::value` reads.

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
/// R, C, L: the number after the nodes, or `R=`, `C=`, `L=`; V, I: all up to AC or an assignment; E, F, G, H: the gain; K: the coefficient.
/// Empty for other kinds, and if the card has a formula or the name of a model there.
[[nodiscard]] std::optional<ValuePlace> place_of_value(const netlist::Card& card);

/// The card up to its value, as text; only its number of words matters.
[[nodiscard]] std::string head_of_value(const netlist::Card& card, const ValuePlace& place);
/// `parsed`: that head with the new value after it.
void replace_value(netlist::Card& card, const ValuePlace& place, const netlist::Card& parsed);

/// The value with parameters evaluated: ohm, farad, henry, V or A of a constant source, a gain, a coefficient. Empty: none.
[[nodiscard]] std::optional<double> value_of(const elements::Instance& instance);

}  // namespace pwlsim::api
