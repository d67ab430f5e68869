#pragma once
/// `.sens`: derivatives of the measurements of `.tran` and `.pss` to parameters, exact.

#include <atomic>
#include <string>
#include <vector>

#include "analysis/derivative_table.hpp"
#include "analysis/json.hpp"
#include "analysis/steady_state.hpp"
#include "circuit/compile.hpp"
#include "steady/parameter_inputs.hpp"

namespace pwlsim::analysis {

/// Existing measurements of the analyses; null: measure again.
struct MeasuredBefore {
  const measure::Record *run = nullptr, *orbit = nullptr;
};

/// For the run of `.tran` from the deck's start, or on the orbit `state` (null: there is none).
[[nodiscard]] DerivativeTable run_derivatives(const circuit::Compiled& compiled, const SteadyState* state,
                                              const std::atomic<int>& interrupt, const measure::Record* measured);
/// For the orbit.
[[nodiscard]] DerivativeTable orbit_derivatives(const circuit::Compiled& compiled, const SteadyState& state,
                                                const std::atomic<int>& interrupt, const measure::Record* measured);
/// For the runs of the deck. `is_exact`: the exact engine did them; others have no derivatives.
[[nodiscard]] DerivativeTable deck_derivatives(const circuit::Compiled& compiled, const SteadyState* state, bool is_exact,
                                               const std::atomic<int>& interrupt, const MeasuredBefore& measured = {});
/// Whether a signal came before all were known.
[[nodiscard]] bool are_interrupted(const DerivativeTable& table);
/// Every measurement and parameter with the same failure.
[[nodiscard]] DerivativeTable failed_derivatives(const circuit::Compiled& compiled, const circuit::Measurements& measurements,
                                                 const std::string& failure);

/// Aligned lines "measurement parameter derivative percent-per-percent".
[[nodiscard]] std::string derivative_text(const DerivativeTable& table, int digits);
[[nodiscard]] std::string derivative_csv(const DerivativeTable& table);
/// Its columns, and its lines, each after `prefix`.
[[nodiscard]] std::vector<std::string> derivative_columns();
[[nodiscard]] std::string derivative_rows(const DerivativeTable& table, const std::string& prefix = "");
/// The member `sensitivities`: a list.
void write_derivatives(JsonWriter& json, const DerivativeTable& table);

}  // namespace pwlsim::analysis
