#include "model/store_values.hpp"

#include <Eigen/LU>
#include <cmath>

#include "model/descriptor.hpp"

namespace pwlsim::model {

StoreValues::StoreValues(const Island& island, const Extraction& extraction) {
  const Assembly assembly(island.network, true);
  const auto& capacitors = island.network.capacitors;
  const auto& inductors = island.network.inductors;
  const auto voltages = static_cast<Eigen::Index>(capacitors.size());
  const auto currents = static_cast<Eigen::Index>(inductors.size());
  coordinates_ = assembly.energy_unit() * extraction.descriptor.store_state;
  sign_ = extraction.descriptor.store_sign;
  rows_ = Matrix::Zero(voltages + currents, coordinates_.cols());
  for (Eigen::Index i = 0; i < voltages; ++i) {
    const auto& capacitor = capacitors[static_cast<std::size_t>(i)];
    names_.push_back("v(" + capacitor.label.name + ")");
    if (capacitor.capacitance != 0.0) rows_.row(i) = coordinates_.row(i) / std::sqrt(std::abs(capacitor.capacitance));
  }
  // Energy coordinates of inductors are Λᵀ i, with L = Λ Λᵀ; their fluxes are L i = Λ Λᵀ i.
  const Matrix lambda = assembly.inductance_root();
  const bool invertible = lambda.rows() == lambda.cols();
  for (const auto& inductor : inductors) names_.push_back((invertible ? "i(" : "flux(") + inductor.label.name + ")");
  if (currents == 0) return;
  const Matrix own = coordinates_.bottomRows(coordinates_.rows() - voltages);
  rows_.bottomRows(currents) = invertible ? Matrix(lambda.transpose().fullPivLu().solve(own)) : Matrix(lambda * own);
}

double StoreValues::energy(const Vector& x) const { return 0.5 * (sign_.array() * (coordinates_ * x).array().square()).sum(); }

}  // namespace pwlsim::model
