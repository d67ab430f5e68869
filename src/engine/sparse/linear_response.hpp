#pragma once
/// The response of a network without diodes and switches to sources of one frequency:  (G + jωE) z = −H w.

#include <complex>
#include <memory>
#include <string>
#include <vector>

#include "engine/sparse/sparse.hpp"

namespace pwlsim::engine::sparse {

class LinearResponse {
 public:
  /// `inputs`: names of sources. The model must outlive it.
  LinearResponse(const SparseModel& model, const std::vector<std::string>& inputs);
  ~LinearResponse();

  /// The name of something that switches; "" where nothing does: only then there is a response.
  [[nodiscard]] static std::string switching(const SparseModel& model);

  /// Of each signal of the model, at `frequency`, Hz. Not finite where it is infinite, and at 0 Hz where a charge decides it that nothing takes away.
  [[nodiscard]] std::vector<std::complex<double>> at(double frequency, const std::vector<std::complex<double>>& amplitudes);

 private:
  class OfPart;
  std::vector<OfPart> parts_;
  std::size_t signals_ = 0;
};

}  // namespace pwlsim::engine::sparse
