#pragma once
/// Element cards -> instances, by the shape of their kind.

#include "circuit/binding.hpp"

namespace pwlsim::circuit {

class Binder : public Binding {
 public:
  using Binding::Binding;

  /// Adds the instance of an element card, of any letter except X. After an error it exists anyway, so that others may refer to
  /// its name; an instance without a kind belongs to an element that cannot be simulated.
  void element(Place& place, const netlist::Card& card);

 private:
  void refuse(const netlist::Card& card);
};

}  // namespace pwlsim::circuit
