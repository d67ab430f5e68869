#pragma once
/// The linear forms of a network.

#include "model/network.hpp"

namespace pwlsim::model {

/// Calls `visit` with every form that is part of an equation: all but the controls of switches and what is saved.
template <class Visit>
void for_each_equation(const Network& network, Visit&& visit) {
  for (const auto& branch : network.branches) visit(branch.voltage);
  for (const auto& injection : network.injections) visit(injection.current);
  for (const auto& complementarity : network.complementarities) visit(complementarity.slack);
}

/// Goes from node to node along branches that hold a voltage (with members p and n), from the nodes whose voltage is known on, as long as that makes more
/// known. `carry(branch, from_p)` sets the voltage of the other node; false: it does not.
template <class Branches, class IsKnown, class Carry>
void spread_voltages(const Branches& branches, const IsKnown& is_known, const Carry& carry) {
  for (bool spreads = true; spreads;) {
    spreads = false;
    for (const auto& branch : branches) {
      const bool from_p = is_known(branch.p);
      if (from_p != is_known(branch.n)) spreads |= carry(branch, from_p);
    }
  }
}

}  // namespace pwlsim::model
