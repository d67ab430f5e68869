#pragma once
/// Factors of  shift·E + G  by shift and position of the ports, the most recently used ones kept.
///
/// Where a position leaves something open (currents of parallel diodes, the potential of a part between open ones), its closing rows get an ε far
/// below the tolerance, more where that still drowns: a diode of ε·R0 in place of none, ε/R0 in place of an open circuit. Currents and voltages are
/// shared by it.

#include <optional>
#include <vector>

#include "engine/sparse/descriptor.hpp"
#include "linalg/klu.hpp"

namespace pwlsim::engine::sparse {

/// A factor with its unit of currents: the mean admittance of a node at that shift, so that pivots of different kinds compare.
class Factor {
 public:
  Factor(const linalg::KluOrdering& ordering, int nodes) : klu_(ordering), nodes_(nodes) {}
  /// r := (shift·E + G)⁻¹ r
  void solve(std::vector<double>& r) const;

 private:
  friend class Factors;
  linalg::KluFactor klu_;
  int nodes_ = 0;
  double unit_ = 1.0;
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
    std::uint64_t used = 0;
  };
  [[nodiscard]] Entry* find(double shift, const Position& on);
  [[nodiscard]] Entry& slot();
  [[nodiscard]] linalg::Factored factor(Entry& entry, bool same_pivots);

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
