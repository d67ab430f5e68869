#include "lcp/solve.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "lcp/lemke.hpp"
#include "lcp/newton_min.hpp"
#include "lcp/principal_pivoting.hpp"
#include "lcp/tolerances.hpp"

namespace pwlsim::lcp {

namespace {

using linalg::Matrix;
using linalg::Vector;

constexpr int most_enumerated = 10;

class Attempt {
 public:
  Attempt(const Matrix& m, const Vector& q) : m_(m), q_(q) {}

  /// Whether the claim stands when z is computed anew from its basis.
  bool accepts(const Solution& claim, Method method) {
    answer_.pivots += claim.pivots;
    answer_.status = claim.status;
    if (claim.status != Status::solved) return false;
    const Solution exact = at_basis(m_, q_, claim.basis);
    answer_.assessment = assess(m_, q_, exact.z);
    answer_.status = answer_.assessment.worst() <= acceptable_residual ? Status::solved : Status::inexact;
    if (answer_.status != Status::solved) return false;
    answer_.method = method;
    answer_.z = exact.z;
    answer_.w = exact.w.cwiseMax(0.0);
    answer_.basis = exact.basis;
    return true;
  }
  AssessedSolution& answer() { return answer_; }

 private:
  const Matrix& m_;
  const Vector& q_;
  AssessedSolution answer_;
};

/// Solvers that follow one path may miss a solution where M is in no class of theirs.
bool enumerated(const Matrix& m, const Vector& q, Attempt& attempt) {
  const auto k = static_cast<int>(q.size());
  if (k > most_enumerated) return false;
  std::vector<unsigned> sets(1U << k);
  std::iota(sets.begin(), sets.end(), 0U);
  std::stable_sort(sets.begin(), sets.end(), [](unsigned a, unsigned b) { return std::popcount(a) < std::popcount(b); });
  for (const unsigned set : sets) {
    std::vector<int> basis;
    for (int i = 0; i < k; ++i)
      if ((set >> i & 1U) != 0) basis.push_back(i);
    Solution claim = at_basis(m, q, std::move(basis));
    if (claim.status == Status::solved && attempt.accepts(claim, Method::enumeration)) return true;
  }
  return false;
}

AssessedSolution try_in_turn(const Matrix& m, const Vector& q) {
  Attempt attempt(m, q);
  if (attempt.accepts(lemke(m, q), Method::lemke)) return attempt.answer();
  const Status of_lemke = attempt.answer().status;
  if (attempt.accepts(newton_min(m, q), Method::newton_min)) return attempt.answer();
  if (attempt.accepts(least_index(m, q), Method::least_index)) return attempt.answer();
  if (attempt.accepts(lemke(m + tolerance::regularisation * Matrix::Identity(q.size(), q.size()), q), Method::regularised))
    return attempt.answer();
  if (enumerated(m, q, attempt)) return attempt.answer();
  AssessedSolution none;
  none.status = of_lemke;
  none.pivots = attempt.answer().pivots;
  none.z = none.w = Vector::Zero(q.size());
  return none;
}

}  // namespace

AssessedSolution solve(const Matrix& m, const Vector& q) {
  const Vector scale = diagonal_scale(m);
  const Matrix scaled = scale.asDiagonal() * m * scale.asDiagonal();
  const Vector scaled_q = scale.asDiagonal() * q;
  AssessedSolution answer = try_in_turn(scaled, scaled_q);
  answer.z = scale.asDiagonal() * answer.z;
  answer.w = answer.w.cwiseQuotient(scale);
  return answer;
}

}  // namespace pwlsim::lcp
