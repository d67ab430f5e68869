#pragma once
/// LTspice's gates, Schmitt triggers, flip-flops, sample-and-hold and transconductance amplifiers as subcircuits of ideal switches, written for the terminals that a card uses.

#include <string>
#include <string_view>

namespace pwlsim::circuit {

enum class Logic {
  buffer,
  inverter,
  conjunction,
  disjunction,
  exactly_one,
  schmitt,
  set_reset,
  d_flip_flop,
  sample_hold,
  transconductance
};

struct LogicType {
  std::string_view name;
  Logic logic = Logic::buffer;
  std::string_view inputs;  ///< terminals that may be used, from 1
  std::size_t least = 1;    ///< required number of inputs
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
  std::string parts;     ///< of an OTA: r and c for its output, h and l for its clamps, i for its limit of the current

  /// Of its subcircuit: "ltspice.and.12.7", "ltspice.dflop.13.67.td".
  [[nodiscard]] std::string name() const;
  [[nodiscard]] bool has_part(char part) const { return parts.find(part) != std::string::npos; }
  [[nodiscard]] bool uses(char input) const { return used.find(input) != std::string::npos; }
};

/// Whether outputs of the subcircuit of that name are always at vlow or at vhigh.
[[nodiscard]] bool has_two_levels(std::string_view name);

/// The switch that represents XSPICE's aswitch: control, its reference, two ends; cntl_off, cntl_on, r_off, r_on.
inline constexpr std::string_view analog_switch = "xspice.aswitch";

/// The subcircuit of that name, as text of a deck; "" for other names. Its ports: the inputs that are used, the outputs, the common; its parameters:
/// vhigh, vlow, ref, vt, vh, td; of an OTA vhigh, vlow, ref, g, iout, isource, isink, rout, cout.
[[nodiscard]] std::string logic_subcircuit(std::string_view name);

}  // namespace pwlsim::circuit
