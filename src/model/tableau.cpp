#include "model/tableau.hpp"

namespace pwlsim::model {

Unknowns::Unknowns(const Network& network, const Carried& choice) : network_(&network) {
  int next = static_cast<int>(network.nodes.size());
  const auto take = [&next](std::size_t count) {
    const int first = next;
    next += static_cast<int>(count);
    return first;
  };
  for (const Resistor& r : network.resistors) low_resistor_.push_back(std::abs(r.resistance) < choice.low_resistance ? next++ : -1);
  for (const char carried : choice.capacitor_currents) capacitor_.push_back(carried != 0 ? next++ : -1);
  first_inductor_ = take(network.inductors.size());
  first_rate_ = take(static_cast<std::size_t>(choice.rates));
  first_branch_ = take(network.branches.size());
  first_complementarity_ = static_cast<int>(network.diodes.size());
  first_switch_ = first_complementarity_ + static_cast<int>(network.complementarities.size());
  first_port_ = take(static_cast<std::size_t>(first_switch_) + network.switches.size());
  size_ = next;
}

const Label& Unknowns::port_label(int port) const {
  if (port < first_complementarity_) return network_->diodes[static_cast<std::size_t>(port)].label;
  if (port < first_switch_) return network_->complementarities[static_cast<std::size_t>(port - first_complementarity_)].label;
  return network_->switches[static_cast<std::size_t>(port - first_switch_)].label;
}

const Label* Unknowns::owner(int column) const {
  if (column < static_cast<int>(network_->nodes.size())) return nullptr;
  for (std::size_t i = 0; i < low_resistor_.size(); ++i)
    if (low_resistor_[i] == column) return &network_->resistors[i].label;
  for (std::size_t i = 0; i < capacitor_.size(); ++i)
    if (capacitor_[i] == column) return &network_->capacitors[i].label;
  if (column < first_rate_) return &network_->inductors[static_cast<std::size_t>(column - first_inductor_)].label;
  if (column < first_branch_) return nullptr;
  if (column < first_port_) return &network_->branches[static_cast<std::size_t>(column - first_branch_)].label;
  return &port_label(column - first_port_);
}

}  // namespace pwlsim::model
