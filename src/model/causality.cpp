#include "model/causality.hpp"

#include <cmath>

namespace pwlsim::model {

using linalg::Wide;

linalg::WideVector causality(linalg::WideMatrix s, const linalg::WideVector& given, double tie) {
  const Eigen::Index k = s.rows();
  linalg::WideVector theta = linalg::WideVector::Zero(k);
  const auto sign_of = [&](Eigen::Index j) { return given[j] != 0 ? given[j] : s(j, j) >= 0 ? Wide{1} : Wide{-1}; };
  // |S_jj + Θ_j| − 1
  const auto size = [&](Eigen::Index j) { return given[j] != 0 ? std::abs(s(j, j) + given[j]) - 1 : std::abs(s(j, j)); };
  for (Eigen::Index round = 0; round < k; ++round) {
    Eigen::Index best = -1;
    for (Eigen::Index j = 0; j < k; ++j)
      if (theta[j] == 0 && (best < 0 || size(j) > size(best) * (1.0 + tie))) best = j;
    theta[best] = sign_of(best);
    const Wide pivot = s(best, best) + theta[best];
    if (pivot == 0) continue;
    for (Eigen::Index i = 0; i < k; ++i) {
      if (theta[i] != 0) continue;
      const Wide factor = s(i, best) / pivot;
      for (Eigen::Index j = 0; j < k; ++j)
        if (theta[j] == 0) s(i, j) -= factor * s(best, j);
    }
  }
  return theta;
}

}  // namespace pwlsim::model
