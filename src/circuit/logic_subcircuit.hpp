#pragma once
/// LTspice's gates, Schmitt triggers and flip-flops as subcircuits of ideal switches, written for the terminals that a card uses.

#include <string>
#include <string_view>

namespace pwlsim::circuit {

enum class Logic { buffer, inverter, conjunction, disjunction, exactly_one, schmitt, set_reset, d_flip_flop };

struct LogicType {
  std::string_view name;
  Logic logic = Logic::buffer;
  std::string_view inputs;  ///< places that may be used, from 1
  std::size_t least = 1;    ///< inputs that it needs
  std::size_t most = 5;
};
/// Null for other names.
[[nodiscard]] const LogicType* find_logic_type(std::string_view name);

/// A device's type and the terminals it uses.
struct LogicDevice {
  const LogicType* type = nullptr;
  std::string used;      ///< inputs, as digits from 1
  std::string outputs;   ///< "6", the complement, and "7"
  bool is_late = false;  ///< Td= is given

  /// Of its subcircuit: "ltspice.and.12.7", "ltspice.dflop.13.67.td".
  [[nodiscard]] std::string name() const;
  [[nodiscard]] bool uses(char input) const { return used.find(input) != std::string::npos; }
};

/// The subcircuit of that name, as text of a deck; "" for other names. Its ports: the inputs that are used, the outputs, the common; its parameters:
/// vhigh, vlow, ref, vt, vh, td.
[[nodiscard]] std::string logic_subcircuit(std::string_view name);

}  // namespace pwlsim::circuit
