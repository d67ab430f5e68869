#include "steady/known_inverse.hpp"

#include "linalg/factorisations.hpp"
#include "steady/tolerances.hpp"

namespace pwlsim::steady {

namespace {

constexpr Eigen::Index most_known = 400;  ///< vectors: what is older is of another map

}  // namespace

KnownInverse::KnownInverse(const DerivativeSpace::Operator& phi)
    : phi_(phi), psi_{[this](Vector& y) { return map(y); }, [this](const Vector& y) { return phi_.measure(y); }} {}

linalg::Vector KnownInverse::applied(Vector y) const {
  for (std::size_t i = factors_.size(); i-- > 0;) {
    const Factor& f = factors_[i];
    y += f.vectors * (f.change * (f.measured.transpose() * phi_.measure(y)));
  }
  return y;
}

bool KnownInverse::map(Vector& y) const {
  const Vector delta = applied(y);
  Vector image = delta;
  if (!phi_.apply(image)) return false;
  y += image - delta;
  return true;
}

void KnownInverse::learn(const DerivativeSpace& space) {
  const int m = space.dimension();
  if (m == 0) return;
  if (count_ + m > most_known) forget();
  const Matrix one = Matrix::Identity(m, m), inverse = Eigen::PartialPivLU<Matrix>(one - space.reduced()).inverse();
  if (!(tolerance::zero_singular_value * inverse.norm() <= 1.0)) return;  // 1 − Φ has none there
  factors_.push_back({space.basis(), space.measured_basis(), inverse - one});
  count_ += m;
}

void KnownInverse::forget() {
  factors_.clear();
  count_ = 0;
}

}  // namespace pwlsim::steady
