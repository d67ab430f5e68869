#pragma once
/// Factors of  shift·E + G  by shift and position of the ports, the most recently used ones kept.
///
/// Where a position leaves something open (currents of parallel diodes, the potential of a part between open ones), its closing rows get an ε far
/// below the tolerance, more where that still drowns: a diode of ε·R0 in place of none, ε/R0 in place of an open circuit. Currents and voltages are
/// shared by it.

#include <Eigen/LU>
#include <memory>
#include <vector>

#include "engine/sparse/descriptor.hpp"
#include "linalg/dense.hpp"
#include "linalg/klu.hpp"

namespace pwlsim::engine::sparse {

/// A factor with its unit of currents: the mean admittance of a node at that shift, so that pivots of different kinds compare.
class Factor {
 public:
  /// r := (shift·E + G)⁻¹ r
  void solve(std::vector<double>& r) const;

 private:
  friend class Factors;
  void solve_base(std::vector<double>& r) const;

  const Descriptor* descriptor_ = nullptr;
  std::shared_ptr<linalg::KluFactor> klu_;
  double unit_ = 1.0;
  bool exact_ = true;  ///< no ε in the closing rows
  /// Few ports of another position than that of klu_: A' = A + Σ e_i (a'_i − a_i)ᵀ over their closing rows, by the formula of Sherman, Morrison
  /// and Woodbury: z = z0 − W S⁻¹ t,  W = A⁻¹ e,  S_ij = a'_i W_j,  t_i = (a'_i − a_i) z0.
  std::vector<int> flips_;
  std::vector<char> flipped_on_;  ///< their new sides
  std::vector<std::vector<double>> columns_;
  linalg::Vector scale_;  ///< S is factored with this scale on both sides
  Eigen::PartialPivLU<linalg::Matrix> small_;
};

class Factors {
 public:
  /// `reltol`: of the run; ε is a thousandth of it, within 1e-10 and 1e-7.
  explicit Factors(const Descriptor& descriptor, double reltol = 1e-5);

  /// Null where the matrix is singular. Valid until the next call. Shifts that agree to 1e-11 count as one.
  [[nodiscard]] const Factor* at(double shift, const Position& on);
  /// After a null: the unknown that the equations leave open, −1: not known.
  [[nodiscard]] int singular_unknown() const { return singular_unknown_; }
  [[nodiscard]] const linalg::KluOrdering::Counts& counts() const { return ordering_.counts; }
  [[nodiscard]] bool out_of_memory() const { return out_of_memory_; }

 private:
  struct Entry {
    double shift = 0.0;
    Position on;
    Factor factor;
    std::uint64_t used = 0;  ///< when last
    int uses = 0;
  };
  [[nodiscard]] Entry* find(double shift, const Position& on);
  [[nodiscard]] Entry& slot(const Position& on);
  [[nodiscard]] linalg::Factored factor(Entry& entry, bool same_pivots);
  [[nodiscard]] bool update(Entry& entry);

  const Descriptor& descriptor_;
  linalg::KluOrdering ordering_;
  double epsilon_;
  std::vector<Entry> entries_;
  std::vector<double> values_;
  std::uint64_t clock_ = 0;
  int singular_unknown_ = -1;
  bool out_of_memory_ = false;
};

}  // namespace pwlsim::engine::sparse
