#include "model/slow_apart.hpp"

#include <utility>

#include "linalg/fast_decays.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

using Eigen::Index;
using linalg::Wide;
using linalg::WideMatrix;

/// A basis whose rounding counts as zero: a leak would read it of states that have no part in it.
Matrix without_rounding(const WideMatrix& basis) {
  const Matrix rounded = basis.cast<double>();
  return (rounded.array().abs() <= tolerance::basis_rounding).select(0.0, rounded);
}

}  // namespace

std::unique_ptr<Mode> with_slow_apart(const System& system, const Mode& whole, const Mode& slow) {
  const Index n = system.n, nz = system.n_zeta, n_slow = slow.n1, n_fast = whole.n1 - slow.n1;
  auto mode = std::make_unique<Mode>();
  Mode& m = *mode;
  m.active = whole.active;
  m.regular = true;
  m.unique_inputs = whole.unique_inputs;
  m.input_unique = whole.input_unique;
  m.free_inputs = whole.free_inputs;
  m.constrained = true;
  m.n1 = whole.n1;
  m.ny = whole.ny;
  m.k = whole.k;
  m.noise = whole.noise;
  m.slow = whole.slow;

  // F in the mode's own coordinates, and in ξ.
  const Matrix own = whole.constrained ? Matrix(whole.basis.transpose() * slow.basis) : slow.basis;
  const Matrix fast = without_rounding(linalg::complement(own.cast<Wide>()));
  m.basis.resize(n, m.n1);
  m.basis << slow.basis, (whole.constrained ? Matrix(whole.basis * fast) : fast);
  m.lift = whole.constrained ? whole.lift : Matrix::Zero(n, nz);
  m.projector = whole.constrained ? whole.projector : Matrix::Identity(n + nz, n + nz);
  const Matrix held = m.basis.rightCols(n_fast).transpose() * slow.lift;  // R_F

  const Matrix turned = whole.flow.a().topLeftCorner(m.n1, m.n1) * fast;
  const Matrix across = own.transpose() * turned, decay = fast.transpose() * turned;  // X and Λ
  const Matrix& sources = system.exosystem->a();
  Matrix a = Matrix::Zero(m.ny, m.ny);
  a.topLeftCorner(n_slow, n_slow) = slow.flow.a().topLeftCorner(n_slow, n_slow);
  a.block(0, n_slow, n_slow, n_fast) = across;
  a.topRightCorner(n_slow, nz) = slow.flow.a().topRightCorner(n_slow, nz) - across * held;
  a.block(n_slow, n_slow, n_fast, n_fast) = decay;
  a.block(n_slow, m.n1, n_fast, nz) = held * sources - decay * held;
  a.bottomRightCorner(nz, nz) = sources;

  const auto rows_of = [&](const Matrix& of_slow, const Matrix& of_whole) {
    const Matrix of_fast = of_whole.leftCols(m.n1) * fast;
    Matrix rows(of_slow.rows(), m.ny);
    rows << of_slow.leftCols(n_slow), of_fast, of_slow.rightCols(nz) - of_fast * held;
    return rows;
  };
  m.guards = rows_of(slow.guards, whole.guards);
  m.outputs = rows_of(slow.outputs, whole.outputs);
  finish_mode(system, m, std::move(a));
  m.guard_noise = whole.guard_noise;
  return mode;
}

}  // namespace pwlsim::model
