#include "model/store_values.hpp"

#include <cmath>

#include "model/assembly.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {}  // namespace

StoreValues::StoreValues(const Island& island, const Extraction& extraction) {
  const Assembly assembly(island.network, true);
  const auto& capacitors = island.network.capacitors;
  const auto& inductors = island.network.inductors;
  const auto voltages = static_cast<Eigen::Index>(capacitors.size());
  const auto currents = static_cast<Eigen::Index>(inductors.size());
  coordinates_ = assembly.energy_unit() * extraction.equations.store_state;
  sign_ = extraction.equations.store_sign;
  capacitors_ = voltages;
  rows_ = Matrix::Zero(voltages + currents, coordinates_.cols());
  for (Eigen::Index i = 0; i < voltages; ++i) {
    const auto& capacitor = capacitors[static_cast<std::size_t>(i)];
    names_.push_back(capacitor.state.empty() ? "v(" + capacitor.label.name + ")" : capacitor.state);
    if (capacitor.capacitance != 0.0) rows_.row(i) = coordinates_.row(i) / std::sqrt(std::abs(capacitor.capacitance));
  }
  if (currents == 0) return;
  // Energy coordinates of inductors are Λᵀ i, with L = Λ Λᵀ; their fluxes are L i = Λ Λᵀ i. A current is known from them where no current
  // in the kernel of Λᵀ holds it.
  const Matrix lambda = assembly.inductance_root();
  const linalg::WideMatrix across = lambda.transpose().cast<linalg::Wide>();
  const Matrix open = linalg::wide_null_space(across, tolerance::rank).cast<double>();
  const Matrix solution = linalg::wide_pseudo_inverse(across, tolerance::rank).cast<double>();
  const Matrix own = coordinates_.bottomRows(coordinates_.rows() - voltages);
  for (Eigen::Index i = 0; i < currents; ++i) {
    const bool known = open.row(i).norm() <= tolerance::rank;
    names_.push_back((known ? "i(" : "flux(") + inductors[static_cast<std::size_t>(i)].label.name + ")");
    rows_.row(voltages + i) = (known ? solution : lambda).row(i) * own;
  }
}

const std::string& StoreValues::of_coordinate(int coordinate) const {
  Eigen::Index store = 0;
  coordinates_.col(coordinate).cwiseAbs().maxCoeff(&store);
  return names_[static_cast<std::size_t>(store)];
}

double StoreValues::energy(const Vector& x) const { return 0.5 * (sign_.array() * (coordinates_ * x).array().square()).sum(); }

double StoreValues::magnetic_energy(const Vector& x) const {
  const Eigen::Index own = coordinates_.rows() - capacitors_;
  return 0.5 * (sign_.tail(own).array() * (coordinates_.bottomRows(own) * x).array().square()).sum();
}

}  // namespace pwlsim::model
