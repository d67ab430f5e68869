#include "model/slow_manifold.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <vector>

#include "linalg/elimination.hpp"
#include "linalg/factorisations.hpp"
#include "linalg/fast_decays.hpp"
#include "linalg/tolerances.hpp"
#include "model/mode.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

using Eigen::Index;
using linalg::columns_of;
using linalg::complement;
using linalg::dominant_subspace;
using linalg::leading_columns;
using linalg::Matrix;
using linalg::orthonormal;
using linalg::product;
using linalg::rows_of;
using linalg::Vector;
using linalg::Wide;
using linalg::WideElimination;
using linalg::WideMatrix;
using linalg::WideVector;

/// Of the first shift: another one, at which rounding is another.
constexpr Wide other_shift = 3.0L;
/// Of every shift, times a power of two: products with it round, so that two shifts differ by all the rounding there is.
constexpr Wide digits_of_shift = 1.2020569031595942854L;
/// The shift, against the slow rates and against the fast ones where those are nothing beside them.
constexpr Wide above_slow = 8.0L, below_fast = 2e-9L;
/// Of the fast rates, so that one loses no more than three digits beside another.
constexpr double most_spread = 1e3;
/// Of the lift: at most, and before a change that does not shrink counts as rounding.
constexpr int most_lifts = 32, fewest_lifts = 3;
constexpr Wide largest_basis_condition = 1e6L;  ///< of WᵀN
constexpr int rounds_of_equilibration = 4;

/// Powers of two s with s_i |m_ij| s_j about one at most, in each row and column.
WideVector equilibration(const WideMatrix& m) {
  WideVector s = WideVector::Ones(m.rows());
  const WideMatrix size = m.cwiseAbs().cwiseMax(m.cwiseAbs().transpose());
  for (int round = 0; round < rounds_of_equilibration; ++round) {
    WideVector next = s;
    for (Index i = 0; i < s.size(); ++i) {
      const Wide largest = s[i] * size.row(i).cwiseProduct(s.transpose()).maxCoeff();
      if (largest > 0) next[i] = s[i] / std::sqrt(largest);
    }
    s = next;
  }
  return s.unaryExpr([](Wide x) { return std::ldexp(Wide{1}, std::ilogb(x)); });
}

/// S, U and the shift; sources behind the states.
struct Resolvent {
  Wide shift = 0;
  WideMatrix states, on_sources;  ///< S: ξ of z_ξ, and of z_ζ
  WideMatrix inputs;              ///< U
  WideMatrix free;                ///< directions of u_J that nothing decides
};

/// False where the mode is not regular.
bool make_resolvent(const System& system, const ShiftedSystem& shifted, const std::vector<int>& active, Resolvent& result) {
  if (!shifted.is_regular) return false;
  result.shift = shifted.shift;
  const WideMatrix m = columns_of(rows_of(shifted.impedances, active), active);
  const WideMatrix rb = columns_of(shifted.of_inputs, active);
  const WideVector scale = equilibration(m);
  const WideElimination ports(scale.asDiagonal() * m * scale.asDiagonal(), tolerance::manifold_pivot);
  const WideMatrix right = scale.asDiagonal() * rows_of(shifted.of_ports, active);
  if (ports.rank() < m.rows()) {
    // Equations that hold of themselves, and inputs that are in none.
    const WideMatrix open = scale.asDiagonal() * ports.kernel();
    const auto is_zero = [](const WideMatrix& x, const WideMatrix& terms) {
      return ((x.cwiseAbs() - tolerance::manifold_identity * terms).array() <= 0).all();
    };
    const WideMatrix left = ports.left_kernel().transpose();
    if (!is_zero(product(left, right), linalg::absolute_product(left, right)) ||
        !is_zero(product(rb, open), linalg::absolute_product(rb, open)))
      return false;
    result.free = open;
  }
  result.inputs = -(scale.asDiagonal() * ports.solve(right));
  const WideMatrix s = shifted.states + product(rb, result.inputs);
  result.states = s.leftCols(system.n);
  result.on_sources = s.rightCols(system.n_zeta);
  return true;
}

/// Orthonormal bases: N and W, and what is orthogonal to them.
struct Bases {
  WideMatrix slow, of_rows, off_slow, off_rows;
};

/// By iteration for the smaller of the slow and the fast subspaces. What is fast in S is slow in S⁻¹ = σ − A_J, whose dominant columns and rows have all their digits however
/// few its others have. `fast_is_dominant`: no fast motion takes another's digits there. `jump`: onto what the mode does not hold at zero (empty: it holds nothing). What it holds
/// may be large in S, and is zero in a power of it: a start there would leave a column of rounding, in which only what is fast may be.
Bases find_bases(const WideMatrix& s, Index fast, bool fast_is_dominant, const WideMatrix& jump) {
  const Index slow = s.rows() - fast;
  Bases bases;
  if (fast_is_dominant && fast < slow) {
    if (const WideElimination elimination(s, 0); elimination.rank() == s.rows()) {
      const WideMatrix inverse = elimination.inverse();
      bases.off_rows = dominant_subspace(inverse, inverse, fast);
      bases.off_slow = dominant_subspace(inverse.transpose(), inverse.transpose(), fast);
      bases.slow = complement(bases.off_slow);
      bases.of_rows = complement(bases.off_rows);
      return bases;
    }
  }
  const WideMatrix start = jump.size() > 0 ? product(s, jump) : s;
  bases.slow = dominant_subspace(s, start, slow);
  bases.of_rows = dominant_subspace(s.transpose(), (jump.size() > 0 ? product(jump, s) : s).transpose(), slow);
  bases.off_slow = complement(bases.slow);
  bases.off_rows = complement(bases.of_rows);
  return bases;
}

/// N, (WᵀN)⁻¹Wᵀ and L of a resolvent, and what they tell.
class SlowMotion {
 public:
  SlowMotion(const System& system, const Resolvent& resolvent) : system_(system), r_(resolvent), n_(system.n), nz_(system.n_zeta) {}

  /// False where they are too nearly orthogonal.
  bool take_subspaces(WideMatrix slow, WideMatrix of_rows) {
    beyond_ = r_.shift * WideMatrix::Identity(nz_, nz_) - system_.exosystem->a().cast<Wide>();
    slow_ = std::move(slow);
    of_rows_ = std::move(of_rows);
    const WideElimination between(product(of_rows_.transpose(), slow_), 0);
    if (between.rank() < slow_.cols()) return false;
    w_ = between.solve(of_rows_.transpose());
    return w_.size() == 0 || w_.norm() < largest_basis_condition;
  }
  void find_lift();
  /// One more step of its fixed point, from a solution at another shift.
  void turn_lift(const WideMatrix& lift) { lift_ = next_lift(lift); }
  void find_motion();
  [[nodiscard]] WideMatrix feedback() const;
  [[nodiscard]] WideMatrix rate() const { return of_state(rate_of_slow_, rate_of_sources_); }
  [[nodiscard]] WideMatrix projector() const;
  [[nodiscard]] const WideMatrix& slow() const { return slow_; }
  [[nodiscard]] const WideMatrix& of_rows() const { return of_rows_; }
  [[nodiscard]] const WideMatrix& lift() const { return lift_; }
  /// Of x, in the columns of slow().
  [[nodiscard]] const WideMatrix& slow_coordinates() const { return w_; }

 private:
  [[nodiscard]] WideMatrix next_lift(const WideMatrix& lift) const;
  [[nodiscard]] WideMatrix of_state(const WideMatrix& of_slow, const WideMatrix& of_sources) const;

  const System& system_;
  const Resolvent& r_;
  Index n_, nz_;
  WideMatrix slow_, of_rows_, w_, lift_;
  WideMatrix beyond_;                          ///< σ − A_ζ
  WideMatrix rate_of_slow_, rate_of_sources_;  ///< ξ' of c and ζ
};

class Splitter {
 public:
  Splitter(const System& system, const Mode& whole, const Cut& cut)
      : system_(system), whole_(whole), cut_(cut), n_(system.n), nz_(system.n_zeta) {
    // What the mode itself holds at zero is faster still: a jump.
    fast_ = cut.fast + (system.n - whole.n1);
  }

  std::optional<SlowManifold> run(const std::vector<int>& active, ShiftedSystems& shifted) {
    const Wide least = std::max(above_slow * static_cast<Wide>(cut_.slow_rate), below_fast * static_cast<Wide>(cut_.fast_rate));
    if (!make_resolvent(system_, shifted.at(digits_of_shift * std::exp2(std::ceil(std::log2(least / digits_of_shift)))), active,
                        resolvent_))
      return std::nullopt;
    const bool is_dominant = !whole_.constrained && cut_.fastest_rate <= most_spread * cut_.fast_rate;  // a jump has no rate
    const WideMatrix jump = whole_.constrained ? jump_of_whole() : WideMatrix();
    Bases bases = find_bases(resolvent_.states, fast_, is_dominant, jump);
    if (!motion_.take_subspaces(std::move(bases.slow), std::move(bases.of_rows))) return std::nullopt;
    off_ = bases.off_slow.transpose();
    f_ = std::move(bases.off_rows);
    motion_.find_lift();
    motion_.find_motion();
    take_motion();
    if (!separate_decays()) return std::nullopt;
    result_.free_inputs = std::move(resolvent_.free);
    return std::move(result_);
  }

 private:
  void take_motion();
  bool separate_decays();
  [[nodiscard]] Matrix rate_of_whole() const;
  [[nodiscard]] WideMatrix jump_of_whole() const { return whole_.projector.topLeftCorner(n_, n_).cast<Wide>(); }
  void align_with_jump();

  const System& system_;
  const Mode& whole_;
  Cut cut_;
  Index n_, nz_, fast_ = 0;
  Resolvent resolvent_;
  SlowMotion motion_{system_, resolvent_};
  WideMatrix off_, f_;  ///< rows orthogonal to N, and F
  SlowManifold result_;
};

/// (Fast part of) (S_ξ L + S_ζ)(σ − A_ζ).
WideMatrix SlowMotion::next_lift(const WideMatrix& lift) const {
  if (nz_ == 0) return lift;
  WideMatrix next = product(product(r_.states, lift) + r_.on_sources, beyond_);
  next -= product(slow_, product(w_, next));
  return next;
}

/// L = (fast part of) (S_ξ L + S_ζ)(σ − A_ζ), by fixed point.
void SlowMotion::find_lift() {
  lift_ = WideMatrix::Zero(n_, nz_);
  Wide last = INFINITY;
  for (int k = 0; k < most_lifts && nz_ > 0; ++k) {
    WideMatrix next = next_lift(lift_);
    const Wide change = (next - lift_).norm();
    lift_ = std::move(next);
    if (change <= linalg::tolerance::converged_subspace * lift_.norm() || (k >= fewest_lifts && !(change < last))) break;
    last = change;
  }
}

/// With X = (N L; 0 1): S X = X Y, so that X' = X (σ − Y⁻¹). By blocks: those of ζ are known.
void SlowMotion::find_motion() {
  const Index slow = slow_.cols();
  const WideMatrix own = WideElimination(product(w_, product(r_.states, slow_)), 0).inverse();
  // S (L; 1) (σ − A_ζ) = L + N (…), whose coordinates are what E_s adds.
  const WideMatrix across = product(w_, product(product(r_.states, lift_) + r_.on_sources, beyond_));
  rate_of_slow_ = product(slow_, r_.shift * WideMatrix::Identity(slow, slow) - own);
  rate_of_sources_ = product(slow_, product(own, across)) + product(lift_, system_.exosystem->a().cast<Wide>());
}

/// What c and ζ make, as rows of x: c = w (ξ − L ζ).
WideMatrix SlowMotion::of_state(const WideMatrix& of_slow, const WideMatrix& of_sources) const {
  WideMatrix rows(of_slow.rows(), n_ + nz_);
  rows.leftCols(n_) = product(of_slow, w_);
  rows.rightCols(nz_) = of_sources - product(rows.leftCols(n_), lift_);
  return rows;
}

/// u_J of X is U X Y⁻¹ = U (σX − X').
WideMatrix SlowMotion::feedback() const {
  const WideMatrix of_states = r_.inputs.leftCols(n_);
  return of_state(product(of_states, r_.shift * slow_ - rate_of_slow_),
                  product(of_states, r_.shift * lift_ - rate_of_sources_) + product(r_.inputs.rightCols(nz_), beyond_));
}

WideMatrix SlowMotion::projector() const {
  WideMatrix result = WideMatrix::Zero(n_ + nz_, n_ + nz_);
  result.topRows(n_) = of_state(slow_, lift_);
  result.bottomRightCorner(nz_, nz_).setIdentity();
  return result;
}

void Splitter::take_motion() {
  const WideMatrix& slow = motion_.slow();
  result_.feedback = motion_.feedback();
  result_.rate = motion_.rate();
  result_.projector = motion_.projector();
  result_.constraints.resize(fast_, n_ + nz_);
  result_.constraints << off_, -product(off_, motion_.lift());
  const auto size = [](const WideMatrix& m) { return Matrix(m.cast<double>().cwiseAbs()); };
  const Matrix change = size(motion_.slow_coordinates()) * (system_.a.topLeftCorner(n_, n_).cwiseAbs() * size(slow));
  result_.rate_doubt = tolerance::rate_rounding * change.norm();
  result_.slow = slow;
  result_.of_rows = motion_.of_rows();
  result_.lift = motion_.lift();
  result_.shift = resolvent_.shift;
}

/// ξ' of ξ in the mode itself, after the jump to what it holds at zero.
Matrix Splitter::rate_of_whole() const {
  const Matrix a = whole_.flow.a().topLeftCorner(whole_.n1, whole_.n1);
  return whole_.constrained ? Matrix(whole_.basis * (a * (whole_.basis.transpose() * whole_.projector.topLeftCorner(n_, n_)))) : a;
}

/// A basis of the fast subspace whose first vectors are those that the mode's jump takes to zero.
void Splitter::align_with_jump() {
  const Index jumps = n_ - whole_.n1;
  const WideMatrix after = product(jump_of_whole(), f_);
  WideMatrix aligned(n_, fast_);
  aligned.leftCols(jumps) = leading_columns(f_ - after, jumps);
  aligned.rightCols(cut_.fast) = leading_columns(after, cut_.fast);
  f_ = std::move(aligned);
}

/// Each decay by itself. What the mode holds at zero is a jump, without a time constant; and so is all of the fast motion where that cannot be told from the decays.
bool Splitter::separate_decays() {
  const bool jumps = whole_.constrained;
  if (jumps) align_with_jump();
  const WideElimination across(product(off_, f_), 0);
  if (across.rank() < fast_) return false;
  result_.slowest = 1.0 / cut_.fast_rate;
  result_.fast = f_.cast<double>();
  result_.coordinates = across.solve(result_.constraints).cast<double>();
  result_.time_constants = Vector::Zero(fast_);
  const Index count = cut_.fast;
  const Matrix lambda = result_.coordinates.bottomLeftCorner(count, n_) * (rate_of_whole() * result_.fast.rightCols(count));
  if (count == 1 && lambda(0, 0) < 0.0) {
    result_.slowest = result_.time_constants[fast_ - 1] = -1.0 / lambda(0, 0);
    result_.are_sharp = true;
    return true;
  }
  const Eigen::EigenSolver<Matrix> solver(lambda);
  if (solver.info() != Eigen::Success) return jumps;
  Vector constants(count);
  for (Index i = 0; i < count; ++i) {
    const std::complex<double> rate = solver.eigenvalues()[i];
    if (!(-rate.real() > linalg::least_damping * std::abs(rate))) return jumps;
    constants[i] = -1.0 / rate.real();
  }
  const Matrix vectors = solver.eigenvectors().real();
  const Eigen::FullPivLU<Matrix> lu(vectors);
  if (!(lu.rcond() > tolerance::eigenvector)) return jumps;
  result_.time_constants.tail(count) = constants;
  result_.slowest = constants.maxCoeff();
  result_.are_sharp = tolerance::unit_rounding * constants.maxCoeff() <= tolerance::sharp_decay * lu.rcond() * constants.minCoeff();
  result_.fast.rightCols(count) *= vectors;
  result_.coordinates.bottomRows(count) = lu.solve(result_.coordinates.bottomRows(count)).eval();
  return true;
}

}  // namespace

Rates rates_by_speed(const Mode& whole, double longest) {
  const Matrix a = whole.flow.a().topLeftCorner(whole.n1, whole.n1);
  return linalg::norm_bound(a) * longest > 1.0 ? linalg::rates_by_speed(a) : Rates{};
}

const ShiftedSystem& ShiftedSystems::at(Wide shift) {
  const auto [place, is_new] = known_.try_emplace(shift);
  ShiftedSystem& result = place->second;
  if (!is_new) return result;
  result.shift = shift;
  const Index n = system_.n, nz = system_.n_zeta;
  const std::shared_ptr<const Unrounded> unrounded = system_.unrounded_matrices();
  const auto shifted = [&](const WideMatrix& m) { return WideMatrix(shift * WideMatrix::Identity(m.rows(), m.rows()) - m); };
  const WideElimination own(shifted(unrounded->a.topLeftCorner(n, n)), 0), sources(shifted(unrounded->a.bottomRightCorner(nz, nz)), 0);
  if (own.rank() < n || sources.rank() < nz) return result;
  const WideMatrix& c = unrounded->c;
  const WideMatrix r = own.inverse(), of_sources = sources.inverse();
  result.states.resize(n, n + nz);
  result.states << r, product(product(r, unrounded->a.topRightCorner(n, nz)), of_sources);
  result.of_inputs = product(r, unrounded->b.topRows(n));
  result.of_ports = product(c.leftCols(n), result.states);
  result.of_ports.rightCols(nz) += product(c.rightCols(nz), of_sources);
  result.impedances = unrounded->d + product(c.leftCols(n), result.of_inputs);
  result.is_regular = true;
  return result;
}

std::optional<SlowManifold> slow_manifold(const System& system, const Mode& whole, const Cut& cut, const std::vector<int>& active,
                                          ShiftedSystems& shifted) {
  return Splitter(system, whole, cut).run(active, shifted);
}

std::optional<Feedback> feedback_at_other_shift(const System& system, const std::vector<int>& active, ShiftedSystems& shifted,
                                                const SlowManifold& first) {
  Resolvent resolvent;
  if (!make_resolvent(system, shifted.at(other_shift * first.shift), active, resolvent)) return std::nullopt;
  SlowMotion motion(system, resolvent);
  // The subspaces of every shift are the same: applied once, this resolvent puts its own rounding in the place of the other's.
  const WideMatrix& s = resolvent.states;
  if (!motion.take_subspaces(orthonormal(product(s, first.slow)), orthonormal(product(s.transpose(), first.of_rows)))) return std::nullopt;
  motion.turn_lift(first.lift);
  motion.find_motion();
  return Feedback{motion.feedback(), std::move(resolvent.free), motion.slow(), motion.lift()};
}

}  // namespace pwlsim::model
