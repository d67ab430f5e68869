#pragma once
/// Element cards -> instances, by the shape their kind describes.

#include "circuit/binding.hpp"

namespace pwlsim::circuit {

class Binder : public Binding {
 public:
  using Binding::Binding;

  /// Adds the instance of an element card, of any letter but X. After an error it is there all the same, so that others may refer to
  /// its name; an instance without a kind is one of an element that cannot be simulated.
  void element(Place& place, const netlist::Card& card);

 private:
  void refuse(const netlist::Card& card);
};

}  // namespace pwlsim::circuit
