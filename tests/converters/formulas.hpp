#pragma once
/// The integrator beside answers in closed form.

namespace pwlsim::test::converters {

/// Largest relative error of circuits with known answers; printed one by one.
[[nodiscard]] double check_formulas();

}  // namespace pwlsim::test::converters
