#pragma once
/// How a network changes with a parameter: derivatives of its numbers, item by item.

#include <optional>
#include <vector>

#include "model/network.hpp"

namespace pwlsim::model {

struct NetworkMove {
  enum class Item {
    resistance,        ///< of Network::resistors[index], Ω
    capacitance,       ///< of capacitors[index], F
    inductance,        ///< of inductors[index], H; couplings keep their coefficients
    coupling,          ///< coefficient of couplings[index]
    diode_drop,        ///< of diodes[index], V
    diode_resistance,  ///< likewise, Ω
    switch_drop,       ///< of switches[index], V
    switch_resistance,
    on_level,  ///< of switches[index], in units of its control
    off_level,
    source,            ///< sources[index]: `function` holds the derivatives of the function's own numbers
    branch_form,       ///< branches[index].voltage
    injection_form,    ///< injections[index].current
    slack_form,        ///< complementarities[index].slack
    control_form,      ///< switches[index].control
    signal_form,       ///< signals[index].form
    initial_voltage,   ///< of capacitors[index], V; counts with uic
    initial_current,   ///< of inductors[index], A; counts with uic
    node_condition,    ///< voltage of node_conditions[index], V
    current_condition  ///< current of current_conditions[index], A
  };
  Item item = Item::resistance;
  int index = 0;
  double derivative = 0.0;
  std::optional<SourceFunction> function{};
  LinearForm form{};  ///< of a form: its derivative, of any quantities
};

/// All that one parameter moves.
using NetworkMoves = std::vector<NetworkMove>;

}  // namespace pwlsim::model
