#pragma once
/// The stores of an island in SI units: voltages of capacitors, currents of inductors, stored energy.

#include <string>
#include <vector>

#include "model/extraction.hpp"

namespace pwlsim::model {

class StoreValues {
 public:
  StoreValues(const Island& island, const Extraction& extraction);

  /// "v(C1)" in V, "i(L1)" in A; "flux(L1)" in Vs of an inductor whose current perfect coupling leaves open; "x(s,1)" of a raw system.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// One a name, from the state x = (ξ, ζ) (system.size() entries).
  [[nodiscard]] Vector values(const Vector& x) const { return rows_ * x; }
  /// values × (ξ, ζ).
  [[nodiscard]] const Matrix& rows() const { return rows_; }
  /// The name of the store with the largest share in this coordinate of ξ.
  [[nodiscard]] const std::string& of_coordinate(int coordinate) const;
  /// J. A negative capacitance or inductance counts negative.
  [[nodiscard]] double energy(const Vector& x) const;
  /// J, of the inductors alone.
  [[nodiscard]] double magnetic_energy(const Vector& x) const;

 private:
  std::vector<std::string> names_;
  Matrix rows_;         ///< values × (ξ, ζ)
  Matrix coordinates_;  ///< energy coordinates of all stores, in √J
  Vector sign_;
  Eigen::Index capacitors_ = 0;  ///< this many first coordinates belong to capacitors
};

}  // namespace pwlsim::model
