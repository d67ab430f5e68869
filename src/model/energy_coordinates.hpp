#pragma once
/// A system as a reader sees it: SI units, states named after elements.
///
///     x' = A x + B u,   y = C x + D u   (sources at zero)
///
/// Each x is in square roots of joule, so that ½ Σ x² is the stored energy: √C·v of a capacitor, √L·i of an inductor. Where coupling, or a loop of
/// capacitors or a cutset of inductors, ties several together, x is a mixture of them: orthonormal in these coordinates, chosen so that it
/// reaches over as few elements as possible.

#include <string>
#include <vector>

#include "model/extraction.hpp"

namespace pwlsim::model {

struct EnergyState {
  struct Term {
    std::string element;       ///< "oc#2": the second store of an element with several, as a raw system has
    bool is_voltage = false;   ///< v of a capacitor; else i of an inductor
    double coefficient = 0.0;  ///< in √F or √H
  };
  std::vector<Term> terms;  ///< x = Σ coefficient·(v or i)
};

struct StateSpace {
  std::vector<EnergyState> states;
  Matrix a, b, c, d;  ///< n×n in 1/s, n×k, k×n, k×k; entries below 1e-14 of what cancels in them are zero
};

[[nodiscard]] StateSpace in_energy_coordinates(const Island& island, const Extraction& extraction);

}  // namespace pwlsim::model
