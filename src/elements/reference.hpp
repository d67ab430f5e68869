#pragma once
/// The element tables of the manual, made from the catalogue.

#include <string>

namespace pwlsim::elements {

/// Markdown: every element, waveform and model type with its parameters, as docs/reference/elements.md holds it.
[[nodiscard]] std::string reference_tables();

}  // namespace pwlsim::elements
