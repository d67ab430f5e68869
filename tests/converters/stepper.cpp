#include "converters/stepper.hpp"

#include <fmt/format.h>

namespace pwlsim::test::converters {
namespace {

constexpr std::size_t most_kept = 20000;

std::string key(const Mode& mode, Real step) { return fmt::format("{} {}", mode, static_cast<double>(step)); }

}  // namespace

std::shared_ptr<Stepper::Factors> Stepper::factor(const Mode& mode, Real step, bool keep) {
  const std::string name = keep ? key(mode, step) : std::string();
  if (keep)
    if (const auto found = kept_.find(name); found != kept_.end()) return found->second;
  auto result = std::make_shared<Factors>();
  Orders& orders = orders_[mode];
  result->solvable = result->real.factor(equations_.matrix<Real>(mode, radau().real_value, step), orders.real);
  for (std::size_t p = 0; p < Radau::pairs && result->solvable; ++p)
    result->solvable = result->complex[p].factor(equations_.matrix<Complex>(mode, radau().complex_values[p], step), orders.complex[p]);
  if (keep) {
    if (kept_.size() > most_kept) kept_.clear();
    kept_[name] = result;
  }
  return result;
}

Trial Stepper::radau_step(const Mode& mode, const Vector& states, const Piece& piece, Real time, Real step, bool keep) {
  Trial result;
  const auto factors = factor(mode, step, keep);
  if (!factors->solvable) return result;
  const Radau& scheme = radau();
  const std::size_t n = equations_.size();
  std::array<Vector, Radau::stages> right;
  for (std::size_t i = 0; i < Radau::stages; ++i)
    right[i] = equations_.right_side(mode, states, time + scheme.nodes[i + 1] * step, piece.inside());
  Vector real(n, 0);
  std::array<std::vector<Complex>, Radau::pairs> complex;
  for (auto& part : complex) part.assign(n, Complex(0));
  for (std::size_t i = 0; i < Radau::stages; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      if (right[i][j] == 0) continue;
      real[j] += scheme.real_row[i] * right[i][j];
      for (std::size_t p = 0; p < Radau::pairs; ++p) complex[p][j] = complex[p][j] + scheme.complex_rows[p][i] * Complex(right[i][j]);
    }
  factors->real.solve(real);
  for (std::size_t p = 0; p < Radau::pairs; ++p) factors->complex[p].solve(complex[p]);
  for (std::size_t i = 0; i < Radau::stages; ++i) {
    Vector change(n);
    for (std::size_t j = 0; j < n; ++j) {
      Real value = scheme.real_vector[i] * real[j];
      for (std::size_t p = 0; p < Radau::pairs; ++p) value += 2 * (scheme.complex_vectors[p][i] * complex[p][j]).re;
      change[j] = value;
    }
    result.solutions[i] = with_states(std::move(change), states);
  }
  result.solved = true;
  return result;
}

bool Stepper::euler_step(const Mode& mode, const Vector& states, const Piece& piece, Real time, Real step, Vector& solution) {
  auto& factors = kept_euler_[key(mode, step)];
  if (!factors) {
    factors = std::make_shared<SparseLu<Real>>();
    if (!factors->factor(equations_.matrix<Real>(mode, 1, step), orders_[mode].euler)) {
      factors.reset();
      return false;
    }
  }
  solution = equations_.right_side(mode, states, time + step, piece.inside());
  factors->solve(solution);
  solution = with_states(std::move(solution), states);
  return true;
}

Vector Stepper::with_states(Vector change, const Vector& states) const {
  for (std::size_t k = 0; k < states.size(); ++k) equations_.add_state(change, k, states[k]);
  return change;
}

}  // namespace pwlsim::test::converters
