#include "model/switch_position.hpp"

#include <algorithm>

namespace pwlsim::model {

namespace {

/// Currents of contacts become those of branches, or nothing.
void replace_contacts(LinearForm& form, const std::vector<int>& branch_of_switch) {
  std::erase_if(form, [&](const Term& term) {
    return term.kind == Term::Kind::switch_current && branch_of_switch[static_cast<std::size_t>(term.index)] < 0;
  });
  for (Term& term : form) {
    if (term.kind != Term::Kind::switch_current) continue;
    term.kind = Term::Kind::branch_current;
    term.index = branch_of_switch[static_cast<std::size_t>(term.index)];
  }
}

}  // namespace

Island in_position(const Island& island, const std::vector<char>& closed) {
  Island result = island;
  Network& network = result.network;
  std::vector<int> branch_of_switch(network.switches.size(), -1);
  for (std::size_t i = 0; i < network.switches.size(); ++i) {
    if (closed[i] == 0 || network.switches[i].p == network.switches[i].n) continue;
    const Switch& contact = network.switches[i];
    const auto index = static_cast<int>(network.branches.size());
    branch_of_switch[i] = index;
    LinearForm voltage;
    if (contact.drop != 0.0) voltage.push_back({Term::Kind::one, 0, contact.drop});
    if (contact.resistance != 0.0) voltage.push_back({Term::Kind::branch_current, index, contact.resistance});
    network.branches.push_back({contact.label, contact.p, contact.n, std::move(voltage)});
  }
  for (Branch& branch : network.branches) replace_contacts(branch.voltage, branch_of_switch);
  for (Injection& injection : network.injections) replace_contacts(injection.current, branch_of_switch);
  for (Complementarity& port : network.complementarities) replace_contacts(port.slack, branch_of_switch);
  for (Diode& diode : network.diodes) {
    if (diode.enabled_by.empty()) continue;
    diode.blocks =
        std::none_of(diode.enabled_by.begin(), diode.enabled_by.end(), [&](int s) { return closed[static_cast<std::size_t>(s)] != 0; });
    diode.enabled_by.clear();
  }
  network.switches.clear();
  network.signals.clear();
  result.switch_number.clear();
  result.signal_number.clear();
  result.controls.clear();
  return result;
}

}  // namespace pwlsim::model
