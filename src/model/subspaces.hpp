#pragma once
/// Consistent and jump subspaces of one mode for any relative degree:
///
///     V_{i+1} = {x : ∃u, Ax + Bu ∈ V_i, Cx + Du = 0},  V_0 = Rⁿ,
///     T_{i+1} = {Ax + Bu : x ∈ T_i, Cx + Du = 0},       T_0 = 0
///
/// (van der Schaft & Schumacher 1996, §4; Hautus & Silverman 1983). B, C, D hold the active ports only.

#include "model/index_set.hpp"
#include "model/system.hpp"

namespace pwlsim::model {

struct Subspaces {
  bool regular = false;            ///< V ⊕ T is the whole space and V reaches every ζ
  linalg::WideMatrix projector;    ///< on V along T
  linalg::WideMatrix feedback;     ///< u = feedback·x keeps x in V, by minimum-norm least squares
  linalg::WideMatrix constraints;  ///< orthonormal rows spanning the complement of V
  linalg::WideMatrix free_inputs;  ///< orthonormal basis of ker [B; D]: directions of u without effect
  double condition = 1.0;
  int dim_v = 0, dim_t = 0;
};

/// The last n_zeta states are sources. Extended precision: ranks are decided here, and what cancels must be seen to.
[[nodiscard]] Subspaces find_subspaces(const linalg::WideMatrix& a, const linalg::WideMatrix& b, const linalg::WideMatrix& c,
                                       const linalg::WideMatrix& d, int n_zeta);

/// Those of the energy states alone, sources at zero, with the ports of `active`.
[[nodiscard]] Subspaces subspaces_without_sources(const System& system, const IndexSet& active);

}  // namespace pwlsim::model
