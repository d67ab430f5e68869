#pragma once
/// Selects the sides of ports with zero current and zero voltage.
///
/// At a point without a jump all other ports stay where they are, so that the complementarity problem of a short Euler step is one of the ports in dispute alone, in
/// its change (start_change.hpp): they are at zero exactly, and the change has digits of its own however short the step. What is found is a candidate that the first derivatives of the guards in its segment must confirm.
///
/// van der Schaft and Schumacher, Math. Control Signals Systems 9 (1996): the problem of the first derivatives.

#include <span>

#include "engine/sparse/port_solver.hpp"
#include "engine/sparse/start_change.hpp"

namespace pwlsim::engine::sparse {

class TieSelector {
 public:
  TieSelector(const Descriptor& descriptor, Factors& factors, const model::Exosystem& exosystem)
      : descriptor_(descriptor), change_(descriptor, exosystem), solver_(descriptor, factors, 0.0) {
    solver_.judge_by_rows();
  }

  /// What counts as zero is measured against this voltage at least.
  void note_voltage(double voltage) { least_ = voltage; }
  /// Inputs of the point are sums of terms as large as this, volts: in the segment that ends there they may have been far larger than they are now.
  void note_input_terms(double terms) { input_terms_ = terms; }
  /// Finds the ports at zero in a point whose position is `on`; `passing` is one of them.
  void find(const std::vector<double>& z, const std::vector<double>& w, const Position& on, int passing);
  /// Their sides after a step of length h, s, in `on`. False: there are none that agree.
  [[nodiscard]] bool decide(const std::vector<double>& z, const std::vector<double>& zeta, double h, Position& on);
  [[nodiscard]] std::uint64_t pivots() const { return solver_.pivots(); }

 private:
  const Descriptor& descriptor_;
  StartChange change_;
  PortSolver solver_;  ///< with scales of its own, those of the change
  double least_ = 0.0, input_terms_ = 0.0;
  std::vector<char> at_zero_;
  std::vector<double> zero_, none_, step_, z_, right_;
};

}  // namespace pwlsim::engine::sparse
