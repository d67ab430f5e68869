#pragma once
/// The inputs of a mode: u_J = K x from y_J = C_J x + D_JJ u_J = 0, with the constraints on x and the jumps that keep to them. Of inputs that are free the least norm.

#include <memory>
#include <vector>

#include "linalg/careful_elimination.hpp"
#include "model/mode.hpp"
#include "model/slow_manifold.hpp"
#include "model/system.hpp"

namespace pwlsim::model {

class ModeInputs {
 public:
  using WideMatrix = linalg::WideMatrix;
  /// The columns of B, the rows of C and the block of D that belong to active ports J; matrices where the inputs are solved for.
  struct Restricted {
    std::vector<int> j;
    WideMatrix b, c, d;
  };

  ModeInputs(const System& system, const IndexSet& active);

  /// False where they are not unique up to what moves nothing. In `mode`: the projector, and which inputs are free.
  bool solve(Mode& mode);
  /// The same from a slow manifold.
  void take(const SlowManifold& manifold, Mode& mode);
  /// Other inputs for the same constraints.
  void take(Feedback& feedback);

  /// The active ports, in their order.
  [[nodiscard]] const std::vector<int>& ports() const { return r_.j; }
  [[nodiscard]] const Restricted& restricted() const { return r_; }
  [[nodiscard]] const Unrounded& unrounded() const { return *w_; }
  /// u_J = k·x.
  [[nodiscard]] const WideMatrix& k() const { return kj_; }
  /// A bound of what rounding of D_JJ and C_J makes of its entries; empty where that is not known.
  [[nodiscard]] const WideMatrix& k_error() const { return kj_error_; }
  /// Rows spanning the complement of V.
  [[nodiscard]] const WideMatrix& constraints() const { return constraints_; }
  [[nodiscard]] double condition() const { return condition_; }

 private:
  void restrict_matrices();
  void take_inverse(const WideMatrix& inverse);
  void leave_out_rounding(Eigen::Index column, const linalg::WideVector& rounding);
  [[nodiscard]] linalg::CarefulElimination examine_feedthrough() const;
  /// What the kernel of D_JJ demands of x, and the jumps along it.
  struct Kernel {
    bool is_all = false;  ///< D_JJ is zero
    WideMatrix right, constraint, jump;
    linalg::WideVector row_bound, column_bound;  ///< norms of the terms of constraint's rows and jump's columns
  };
  Kernel kernel_of(const linalg::CarefulElimination& elimination);
  bool solve_with_kernel(const linalg::CarefulElimination& elimination, Mode& mode);
  bool solve_generally(const linalg::CarefulElimination& elimination, Mode& mode);
  WideMatrix share_by_least_norm(const WideMatrix& free_directions);
  void take_least_norm(const WideMatrix& free_directions, Mode& mode);

  const System& s_;
  std::shared_ptr<const Unrounded> w_;
  Restricted r_;
  WideMatrix kj_, kj_error_, constraints_;
  double condition_ = 1.0;
};

}  // namespace pwlsim::model
