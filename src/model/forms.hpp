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

}  // namespace pwlsim::model
