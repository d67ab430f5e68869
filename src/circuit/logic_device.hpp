#pragma once
/// LTspice's own A devices (gates, Schmitt triggers, flip-flops): eight nodes before their type, five inputs, the complement, the output and the
/// common; unused terminals are tied to the common. Each becomes the call of a subcircuit of ideal switches that is generated for the terminals it
/// uses (LTspice's help, "A. Special Functions").

#include <string_view>

#include "circuit/definitions.hpp"
#include "circuit/reporter.hpp"

namespace pwlsim::circuit {

/// Replaces A devices of known types by calls. Others are errors: their cards stay.
void replace_logic_devices(Definitions& definitions, Reporter& reporter);

/// The parameters of such a call.
[[nodiscard]] bool must_not_be_negative(std::string_view parameter);

}  // namespace pwlsim::circuit
