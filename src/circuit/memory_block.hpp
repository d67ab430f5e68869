#pragma once
/// Blocks with states that expressions ask for: idt(x), ddt(x), LAPLACE.

#include <functional>
#include <optional>
#include <string_view>

#include "circuit/bind.hpp"

namespace pwlsim::circuit {

/// A block of one of the A element's types ("int", "d_dt", "s_xfer") behind an expression, beside the element `owner` and not saved by default.
struct MemoryBlock {
  std::string_view type;
  const netlist::Expression& input;
  std::function<void(elements::Values&)> set_values;
};

/// The node of its output; none after an error.
[[nodiscard]] std::optional<model::NodeIndex> add_memory_block(Binder& binder, Place& place, const elements::Instance& owner,
                                                               const MemoryBlock& block);

/// The same for a transfer function: an item that holds a fraction of polynomials in s.
[[nodiscard]] std::optional<model::NodeIndex> add_transfer_block(Binder& binder, Place& place, const elements::Instance& owner,
                                                                 const netlist::Expression& input, const netlist::Item& fraction);

}  // namespace pwlsim::circuit
