#include "model/modal_form.hpp"

#include <algorithm>
#include <cmath>

#include "linalg/factorisations.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

using linalg::Wide;
using linalg::WideMatrix;
using Places = std::vector<Eigen::Index>;

constexpr Eigen::Index largest_form = 64;       ///< states; beyond, the search would cost more than it saves
constexpr Eigen::Index largest_wide_form = 24;  ///< beyond, eigenvectors in extended precision cost more than the search saves
constexpr Wide largest_condition = 1e7L;        ///< of eigenvectors: what extended precision has to spare goes into it

/// Of y, what moves by a rate of its own, and levels and ramps.
void sort_places(const System& system, const Mode& mode, Places& moved, Places& given) {
  for (Eigen::Index i = 0; i < mode.n1; ++i) moved.push_back(i);
  for (const auto& block : system.exosystem->blocks()) {
    Places& places = block.is_curved() ? moved : given;
    for (int i = 0; i < block.size(); ++i) places.push_back(mode.n1 + block.first + i);
  }
}

/// Whether no coordinate is pushed by the others' rounding faster than its own rate tells.
bool knows_every_rate(const Matrix& rest, const WideMatrix& lambda, Wide least) {
  Wide slowest = INFINITY;
  for (Eigen::Index i = 0; i < lambda.rows(); ++i)
    if (const Wide rate = lambda.row(i).norm(); rate > least) slowest = std::min(slowest, rate);
  if (slowest == static_cast<Wide>(INFINITY)) slowest = least;
  for (Eigen::Index i = 0; i < lambda.rows(); ++i)
    if (!(rest.row(i).norm() <= tolerance::rate_error * std::max(lambda.row(i).norm(), slowest))) return false;
  return true;
}

/// Whether that moves none visibly within `longest`.
bool hides_no_motion(const Matrix& rest, double longest) { return rest.rowwise().norm().maxCoeff() * longest <= tolerance::motion_error; }

/// ‖V‖‖W‖, W = V⁻¹: what cancels in the modes' coordinates.
Wide condition(const WideMatrix& v, const WideMatrix& w) { return v.norm() * w.norm(); }

/// The same with sources in the unit in which they move the states as fast as these move themselves, and eigenvectors of length 1. `states`: the first rows.
Wide condition_in_own_units(const WideMatrix& m, WideMatrix v, WideMatrix w, Eigen::Index states) {
  const Wide rate = m.topLeftCorner(states, states).norm(), push = m.topRightCorner(states, m.cols() - states).norm();
  if (rate > 0.0L && push > 0.0L) {
    v.bottomRows(v.rows() - states) *= push / rate;
    w.rightCols(w.cols() - states) *= rate / push;
  }
  w.array().colwise() *= v.colwise().norm().transpose().array();
  return condition(v.colwise().normalized(), w);
}

struct Eigenvectors {
  WideMatrix v, lambda;
};

/// Of a pair λ, λ* the columns are the real and the imaginary part of one eigenvector, and Λ has a block (Re λ, Im λ; −Im λ, Re λ). Empty: not found.
template <class M>
Eigenvectors eigenvectors(const M& m) {
  const Eigen::EigenSolver<M> solver(m);
  if (solver.info() != Eigen::Success) return {};
  return {solver.pseudoEigenvectors().template cast<Wide>(), solver.pseudoEigenvalueMatrix().template cast<Wide>()};
}

/// V Λ, whose blocks are those of pairs.
WideMatrix times_blocks(const WideMatrix& v, const WideMatrix& lambda) {
  WideMatrix result(v.rows(), v.cols());
  for (Eigen::Index j = 0; j < v.cols(); ++j) {
    result.col(j) = v.col(j) * lambda(j, j);
    if (j > 0 && lambda(j - 1, j) != 0.0L) result.col(j) += v.col(j - 1) * lambda(j - 1, j);
    if (j + 1 < v.cols() && lambda(j + 1, j) != 0.0L) result.col(j) += v.col(j + 1) * lambda(j + 1, j);
  }
  return result;
}

/// Rows of complex numbers, of which `from` has real and (negative) imaginary parts as the columns of pairs have them.
Matrix in_pairs(const WideMatrix& from, const std::vector<ModalRate>& rates, Wide sign) {
  Matrix result = Matrix::Zero(2 * static_cast<Eigen::Index>(rates.size()), from.cols());
  Eigen::Index i = 0;
  for (std::size_t k = 0; k < rates.size(); ++k, ++i) {
    const auto row = static_cast<Eigen::Index>(2 * k);
    result.row(row) = from.row(i).cast<double>();
    if (!rates[k].is_real) result.row(row + 1) = (sign * from.row(++i)).cast<double>();
  }
  return result;
}

ModalRate rate_of(std::complex<double> value) {
  const std::complex<double> inverse = value == 0.0 ? 0.0 : 1.0 / value;
  const double size = std::abs(value);
  return {value, inverse, size, 1.0 / size, -1.0 / value.real(), value.imag() == 0.0};
}

}  // namespace

std::unique_ptr<ModalForm> modal_form(const System& system, const Mode& mode, double longest) {
  Places moved, given;
  sort_places(system, mode, moved, given);
  const auto n = static_cast<Eigen::Index>(moved.size());
  if (n == 0 || n > largest_form) return nullptr;
  const WideMatrix a = mode.flow.a().cast<Wide>();
  const WideMatrix m = a(moved, moved), on_given = a(moved, given), given_rates = a(given, given);
  const auto [v, lambda] = n <= largest_wide_form ? eigenvectors(m) : eigenvectors(Matrix(m.cast<double>()));
  if (v.size() == 0) return nullptr;
  const WideMatrix w = Eigen::PartialPivLU<WideMatrix>(v).inverse();
  if (!(condition(v, w) < largest_condition) && !(condition_in_own_units(m, v, w, mode.n1) < largest_condition)) return nullptr;
  const Matrix residual = (m * v - times_blocks(v, lambda)).cast<double>(), rest = w.cast<double>() * residual;
  const bool is_known = knows_every_rate(rest, lambda, tolerance::slowest_rate * m.norm());
  if (!is_known && !hides_no_motion(rest, longest)) return nullptr;

  auto form = std::make_unique<ModalForm>();
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool pair = i + 1 < n && lambda(i, i + 1) != 0.0L;
    form->rates.push_back(rate_of({static_cast<double>(lambda(i, i)), pair ? static_cast<double>(lambda(i, i + 1)) : 0.0}));
    if (pair) ++i;
  }
  WideMatrix velocities = WideMatrix::Zero(n, mode.ny), pushes = velocities;
  velocities(Eigen::all, moved) = times_blocks(w.transpose(), lambda.transpose()).transpose();
  velocities(Eigen::all, given) = w * on_given;
  pushes(Eigen::all, given) = w * on_given * given_rates;
  const WideMatrix guards = mode.guards.cast<Wide>();
  // With coordinates s, t of the two columns of a pair z = s − i t, and p·(Re v s + Im v t) = Re (p·v) z.
  form->velocities = in_pairs(velocities, form->rates, -1);
  form->pushes = in_pairs(pushes, form->rates, -1);
  const WideMatrix moved_guards = guards(Eigen::all, moved), given_guards = guards(Eigen::all, given);
  form->weights = in_pairs((moved_guards * v).transpose(), form->rates, 1);
  form->weight_sizes = Matrix(form->weights.rows() / 2, form->weights.cols());
  for (Eigen::Index k = 0; k < form->weight_sizes.rows(); ++k)
    form->weight_sizes.row(k) = form->weights.middleRows(2 * k, 2).colwise().norm();
  form->absolute_velocities = form->velocities.cwiseAbs();
  if (!is_known) {
    WideMatrix unknown = WideMatrix::Zero(n, mode.ny);  // whatever the coordinates are later on
    unknown(Eigen::all, moved) = Matrix(rest.cwiseAbs() * w.cast<double>().cwiseAbs()).cast<Wide>();
    form->velocity_errors = in_pairs(unknown, form->rates, 1);
  }
  form->drift = Matrix::Zero(guards.rows(), mode.ny);
  const Matrix drift = (given_guards * given_rates).cast<double>();
  for (std::size_t k = 0; k < given.size(); ++k) form->drift.col(given[k]) = drift.col(static_cast<Eigen::Index>(k));
  return form;
}

}  // namespace pwlsim::model
