#pragma once
/// Derivatives of all measurements of one run to all parameters, forward along each parameter or backwards from each measurement.

#include <atomic>
#include <string>
#include <vector>

#include "analysis/measured_derivative.hpp"
#include "circuit/analyses.hpp"
#include "steady/adjoint.hpp"

namespace pwlsim::analysis {

/// How parameters change the start and the end of a run.
class RunMotion {
 public:
  struct Forward {
    steady::Followed followed;
    DirectMoves direct;
    std::string failure;
    bool is_kink = false;  ///< the derivative differs on each side
  };
  virtual ~RunMotion() = default;
  /// Why there are no derivatives to the parameter; "" if there are.
  [[nodiscard]] virtual std::string failure(std::size_t parameter) = 0;
  /// Directions in which the start is not determined: only measurements that do not depend on them have derivatives.
  [[nodiscard]] virtual std::vector<steady::Vector> free_directions() const { return {}; }
  [[nodiscard]] virtual Forward forward(std::size_t parameter) = 0;
  /// Its failures as far as diodes rest.
  [[nodiscard]] virtual Forward forward_to_last_rest(std::size_t parameter) { return forward(parameter); }
  /// The sum for each parameter; the values of failed ones are not used.
  [[nodiscard]] virtual std::vector<double> backward(const MeasuredSum& sum, const steady::Adjoint& adjoint) = 0;
};

/// For each parameter the derivatives of all measurements. Once `interrupt` is nonzero no further parameter or measurement is begun.
[[nodiscard]] std::vector<std::vector<TwoSided>> derivative_columns(const circuit::SensitivityAnalysis& card, const MeasuredPass& run,
                                                                    const steady::Sensitivity& sensitivity, RunMotion& motion,
                                                                    const std::atomic<int>& interrupt);

}  // namespace pwlsim::analysis
