#pragma once
/// Factors of  shift·E + G  by shift and position of the ports, the most recently used ones kept.
///
/// Where a position leaves something open (currents of parallel diodes, the potential of a part between blocking ones; open_parts.hpp), the closing rows
/// of the ports that settle it are tied: a bit of u in s = 0, of s in u = 0, which carries nothing unless the position contradicts the network.
/// Where the graph does not tell (controlled sources, perfectly coupled inductors) all closing rows get an ε far below the tolerance, more where that
/// still drowns.

#include <Eigen/Cholesky>
#include <memory>
#include <optional>
#include <unordered_set>
#include <vector>

#include "engine/sparse/open_parts.hpp"
#include "linalg/dense.hpp"
#include "linalg/factorisations.hpp"
#include "linalg/klu.hpp"

namespace pwlsim::engine::sparse {

/// A factor with its unit of currents: the mean admittance of a node at that shift, so that pivots of different kinds compare.
class Factor {
 public:
  /// r := (shift·E + G)⁻¹ r
  void solve(std::vector<double>& r) const;
  /// Its closing rows, where ε is in them.
  [[nodiscard]] const std::optional<Descriptor::Closing>& closing() const { return closing_; }
  /// Ports whose closing rows are tied.
  [[nodiscard]] const std::vector<int>& ties() const { return ties_; }
  /// Its matrix is that of the position as it stands: no closing row has ε, or is tied.
  [[nodiscard]] bool is_as_it_stands() const { return !closing_ && ties_.empty(); }
  /// The largest admittance that meets in a node, times R0; only where there are ties.
  [[nodiscard]] double stiffest() const { return stiffest_; }
  /// What the ties settle, one vector of unknowns each, largest entry one; none where there are too many.
  [[nodiscard]] const std::vector<std::vector<double>>& open() const { return open_; }
  /// x = (JᵀJ)⁻¹ r, J the free variables of all ports in the open vectors.
  [[nodiscard]] linalg::Vector share_out(const linalg::Vector& r) const { return shares_.solve(r); }

 private:
  friend class Factors;
  void solve_base(std::vector<double>& r) const;
  [[nodiscard]] const DescriptorPort& flipped(std::size_t i) const { return descriptor_->ports()[static_cast<std::size_t>(flips_[i])]; }

  const Descriptor* descriptor_ = nullptr;
  std::shared_ptr<linalg::KluFactor> klu_;
  double unit_ = 1.0;
  std::optional<Descriptor::Closing> closing_;
  std::vector<int> ties_;
  double stiffest_ = 0.0;
  std::vector<std::vector<double>> open_;
  Eigen::LDLT<linalg::Matrix> shares_;
  /// Few ports of another position than that of klu_: A' = A + Σ e_i (a'_i − a_i)ᵀ over their closing rows, by the formula of Sherman, Morrison
  /// and Woodbury: z = z0 − W S⁻¹ t,  W = A⁻¹ e,  S_ij = a'_i W_j,  t_i = a'_i z0 − r_i,  z0 that of r without
  /// these rows.
  std::vector<int> flips_;
  std::vector<char> flipped_on_;  ///< their new sides
  /// A⁻¹ e of ports, by number, found where one is first needed; one list for all positions that are reached from klu_'s.
  struct Columns {
    std::vector<std::vector<double>> of_port;
    std::size_t count = 0;
    std::vector<double> values;              ///< the matrix
    std::vector<double> known, right, size;  ///< a solution with its right-hand side, and the sizes of its rows' terms
  };
  std::shared_ptr<Columns> columns_;
  linalg::Vector scale_;  ///< S is factored with this scale on both sides
  Eigen::PartialPivLU<linalg::Matrix> small_;
};

class Factors {
 public:
  /// `reltol`: of the run; ε is a thousandth of it, within 1e-10 and 1e-7.
  Factors(const model::Network& network, const Descriptor& descriptor, double reltol = 1e-5);
  /// From now on a position has a factor of its own with the largest pivots: solutions by columns of another's are right to the largest unknown only.
  void keep_digits() {
    keeps_digits_ = true;
    ordering_.pivot_on_largest();
  }

  /// Null where the matrix is singular. Valid until the next call. Shifts that agree to 1e-11 count as one.
  [[nodiscard]] const Factor* at(double shift, const Position& on);
  /// By columns of the factor that was used last: right to the largest unknowns only. Nothing where that is none to begin from, or too many ports tell them apart.
  struct Rough {
    Factor factor;
    double shift;
  };
  [[nodiscard]] std::optional<Rough> rough(const Position& on);
  /// Whether ports that conduct in the second position may share currents that they do not in the first. Where the graph does not tell, they may.
  [[nodiscard]] bool may_share(const Position& on, const Position& shared) const {
    return !parts_ || !parts_->tells_all() || parts_->loops(shared) > parts_->loops(on);
  }
  /// After a null: the unknown that the equations leave open, −1: not known.
  [[nodiscard]] int singular_unknown() const { return singular_unknown_; }
  [[nodiscard]] const linalg::KluOrdering::Counts& counts() const { return ordering_.counts; }
  [[nodiscard]] const linalg::KluOrdering& ordering() const { return ordering_; }
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
  [[nodiscard]] static std::size_t key(double shift, const Position& on);
  void keep_more_if_missed(double shift, const Position& on);
  [[nodiscard]] linalg::Factored factor(Entry& entry, const std::vector<int>& ties, bool same_pivots);
  [[nodiscard]] linalg::Factored factor(Entry& entry, const Descriptor::Closing& closing, const linalg::KluFactor* pivots);
  [[nodiscard]] const linalg::KluFactor* like(const Entry& entry) const;
  void find_open(Entry& entry);
  /// Another than the first, of its matrix as it stands or tied.
  [[nodiscard]] static bool has_own_factor(const Entry& entry, const Entry& other);
  /// The same, at the same shift.
  [[nodiscard]] static bool is_base_of(const Entry& entry, const Entry& other);
  [[nodiscard]] const linalg::KluFactor* latest(const Entry& entry) const;
  [[nodiscard]] const Entry* nearest(const Entry& entry) const;
  [[nodiscard]] const std::vector<double>& column(const Factor& base, int port) const;
  [[nodiscard]] std::optional<Factor> reach(const Entry& base, const Position& on, std::size_t most_columns) const;
  [[nodiscard]] bool update(Entry& entry);
  [[nodiscard]] bool recovers(const Factor& factor, double shift, const Descriptor::Closing& closing);
  [[nodiscard]] static double own_solution(std::size_t i);
  void note_known(const Entry& base);
  [[nodiscard]] double backward_error(const Factor& factor) const;

  const Descriptor& descriptor_;
  std::optional<OpenParts> parts_;  ///< of a passive network
  linalg::KluOrdering ordering_;
  double epsilon_;
  std::vector<Entry> entries_;
  std::size_t kept_;                          ///< factors
  std::unordered_set<std::size_t> given_up_;  ///< keys of factors that were given up for others
  std::size_t made_ = 0, missed_ = 0;         ///< factors since the last look, and those of them that had been given up
  std::vector<double> values_;
  struct {
    double shift = 0.0, unit = 1.0;
  } unit_;  ///< of currents, at the last shift
  std::uint64_t clock_ = 0;
  std::size_t last_ = 0;  ///< entry used last
  int singular_unknown_ = -1;
  bool out_of_memory_ = false, keeps_digits_ = false;
};

}  // namespace pwlsim::engine::sparse
