#pragma once
/// One step of the independent integrator in a mode; factorizations are kept.

#include <array>
#include <memory>
#include <unordered_map>

#include "converters/equations.hpp"
#include "converters/radau.hpp"

namespace pwlsim::test::converters {

/// A piece of time in which sources are smooth and gates constant.
struct Piece {
  Real from = 0, to = 0;
  std::string gates;
  [[nodiscard]] Real inside() const { return (from + to) / 2; }
};

struct Trial {
  bool solved = false;
  std::array<Vector, Radau::stages> solutions;  ///< at the stages; the last is the end of the step
};

class Stepper {
 public:
  explicit Stepper(const Equations& equations) : equations_(equations) {}

  /// A step of Radau IIA from `states` at `time`; `keep`: other steps will have the same length.
  [[nodiscard]] Trial radau_step(const Mode& mode, const Vector& states, const Piece& piece, Real time, Real step, bool keep);
  /// A step of implicit Euler.
  [[nodiscard]] bool euler_step(const Mode& mode, const Vector& states, const Piece& piece, Real time, Real step, Vector& solution);

 private:
  struct Factors {
    bool solvable = false;
    SparseLu<Real> real;
    std::array<SparseLu<Complex>, Radau::pairs> complex;
  };
  struct Orders {
    std::optional<PivotOrder> real, euler;
    std::array<std::optional<PivotOrder>, Radau::pairs> complex;
  };

  [[nodiscard]] std::shared_ptr<Factors> factor(const Mode& mode, Real step, bool keep);
  [[nodiscard]] Vector with_states(Vector change, const Vector& states) const;

  const Equations& equations_;
  std::unordered_map<Mode, Orders> orders_;
  std::unordered_map<std::string, std::shared_ptr<Factors>> kept_;
  std::unordered_map<std::string, std::shared_ptr<SparseLu<Real>>> kept_euler_;
};

}  // namespace pwlsim::test::converters
