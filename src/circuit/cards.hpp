#pragma once
/// The cards that begin with a dot (except those that the reader of decks processes: .include, .lib, .control, .end), and the elements that are known but cannot be simulated: as data.

#include <span>
#include <string_view>

namespace pwlsim::circuit {

enum class CardRole {
  subcircuit,         ///< .subckt
  end_of_subcircuit,  ///< .ends
  parameter,
  function,
  model,
  global,
  condition,  ///< .ic
  options,
  transient,
  operating_point,
  steady_state,  ///< .pss, .pop
  small_signal,  ///< .ac
  sensitivity,   ///< .sens
  save,          ///< .save, .probe
  print,         ///< .print tran …
  measurement,
  fourier,
  sweep,
  machine,
  machine_part,  ///< .state, .rule, .output
  end_of_machine,
  raw_system,  ///< .lcs
  section,     ///< .if to .endif
  ltspice,     ///< shows which program wrote the deck
  silent,      ///< accepted without effect
  ignored      ///< one warning
};

struct CardKind {
  std::string_view name;  ///< with its dot
  CardRole role = CardRole::silent;
  std::string_view text;  ///< what it does, one phrase
};

[[nodiscard]] std::span<const CardKind> card_kinds();
/// The card of that name; null if unknown.
[[nodiscard]] const CardKind* find_card(std::string_view name);

/// Why a card whose name begins with this letter is not an element here.
struct RefusedElement {
  char letter = '?';
  std::string_view name;
};
[[nodiscard]] const RefusedElement* find_refused_element(char letter);

/// `.model` types that other simulators know and no element here takes.
[[nodiscard]] bool is_foreign_model_type(std::string_view type);

}  // namespace pwlsim::circuit
