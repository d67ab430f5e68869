#pragma once
/// The directions that the states of sources take from a point on: of each rate of its own one, of a sinusoid two, of levels and ramps together one and their slope.
///
/// Motions of the sources stay in their span, and so does what Krylov vectors have of the sources: with few numbers each, however many sources there are.

#include <vector>

#include "linalg/dense.hpp"
#include "model/exosystem.hpp"

namespace pwlsim::engine::sparse {

class SourceDirections {
 public:
  SourceDirections(const model::Exosystem& exosystem, const linalg::Vector& zeta);

  [[nodiscard]] Eigen::Index size() const { return along_.cols(); }
  /// Of columns of sources' states in the span.
  [[nodiscard]] linalg::Matrix coordinates(const linalg::Matrix& zetas) const { return dual_ * zetas; }
  /// The coordinates of ζ itself.
  [[nodiscard]] linalg::Vector own() const;
  /// ζ' = A_w ζ in coordinates.
  [[nodiscard]] const linalg::Matrix& rates() const { return rates_; }
  /// What magnitudes of coordinates become at most within τ.
  [[nodiscard]] linalg::Vector reach(const linalg::Vector& sizes, double tau) const;

 private:
  struct Group {
    bool turns = false;
    double omega = 0.0, damping = 0.0;  ///< without both: levels and ramps
    linalg::Vector zeta;
    Eigen::Index first = 0, size = 1;
  };
  void collect(const model::Exosystem& exosystem, const linalg::Vector& zeta);
  void add(const linalg::Vector& direction);
  void add_levels(Group& group, const model::Exosystem& exosystem);
  void add_turning(Group& group, const model::Exosystem& exosystem);

  std::vector<Group> groups_;
  linalg::Matrix along_, dual_, rates_;
};

}  // namespace pwlsim::engine::sparse
