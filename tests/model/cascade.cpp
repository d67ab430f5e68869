#include "model/cascade.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "lcp/solve.hpp"

namespace pwlsim::model {

namespace {

using linalg::Matrix;
using linalg::Vector;
using linalg::Wide;
using linalg::WideMatrix;
using linalg::WideVector;

constexpr Wide sum_rounding = 64 * 1.084202172485504e-19L;  ///< of a sum of a few products, in units of its terms
constexpr Wide rank_tolerance = 1e-10L;                     ///< pivots of an equilibrated block
constexpr double share_of_norm = 0.1;                       ///< an error of x counts in every entry by this share of its norm
constexpr int most_enumerated = 10;

enum class Side : char { undetermined, active, inactive };

std::vector<int> members(unsigned bits, int k) {
  std::vector<int> set;
  for (int i = 0; i < k; ++i)
    if ((bits >> static_cast<unsigned>(i)) & 1U) set.push_back(i);
  return set;
}

/// Solves M z = right for a square M, rows and columns divided by their largest entries.
class ScaledBlock {
 public:
  explicit ScaledBlock(const WideMatrix& m) : row_scale_(WideVector::Ones(m.rows())), column_scale_(WideVector::Ones(m.rows())) {
    WideMatrix scaled = m;
    for (Eigen::Index i = 0; i < m.rows(); ++i)
      if (const Wide size = scaled.row(i).cwiseAbs().maxCoeff(); size > 0) scaled.row(i) *= (row_scale_[i] = 1 / size);
    for (Eigen::Index j = 0; j < m.cols(); ++j)
      if (const Wide size = scaled.col(j).cwiseAbs().maxCoeff(); size > 0) scaled.col(j) *= (column_scale_[j] = 1 / size);
    if (m.rows() > 0) lu_.compute(scaled);
    lu_.setThreshold(rank_tolerance);
  }
  [[nodiscard]] bool regular() const { return row_scale_.size() == 0 || lu_.isInvertible(); }
  [[nodiscard]] WideMatrix inverse() const {
    if (row_scale_.size() == 0) return WideMatrix(0, 0);
    return column_scale_.asDiagonal() * lu_.inverse() * row_scale_.asDiagonal();
  }
  /// Whether some z solves M z = right within `error` of each entry.
  [[nodiscard]] bool consistent(const WideVector& right, const WideVector& error) const {
    const WideVector z = column_scale_.asDiagonal() * lu_.solve(row_scale_.cwiseProduct(right));
    const WideVector left =
        row_scale_.cwiseInverse().asDiagonal() * (lu_.reconstructedMatrix() * column_scale_.cwiseInverse().cwiseProduct(z));
    const Wide slack = rank_tolerance * (right.cwiseAbs().maxCoeff() + left.cwiseAbs().maxCoeff());
    for (Eigen::Index i = 0; i < right.size(); ++i)
      if (std::abs(left[i] - right[i]) > error[i] + slack) return false;
    return true;
  }

 private:
  WideVector row_scale_, column_scale_;
  Eigen::FullPivLU<WideMatrix> lu_;
};

bool all_minors_positive(const WideMatrix& m) {
  const auto k = static_cast<int>(m.rows());
  for (unsigned bits = 1; bits < (1U << static_cast<unsigned>(k)); ++bits) {
    const std::vector<int> set = members(bits, k);
    const WideMatrix block = m(set, set);
    if (!ScaledBlock(block).regular() || block.determinant() <= 0) return false;
  }
  return true;
}

bool is_positive_definite(const WideMatrix& m) {
  const Matrix rounded = m.cast<double>();
  return Eigen::LLT<Matrix>(rounded + rounded.transpose()).info() == Eigen::Success;
}

/// The first parameter in which each row is not zero (−1: none), and those rows.
std::vector<int> leading_indices(const std::vector<WideMatrix>& markov, WideMatrix& leading) {
  const auto k = markov.front().rows();
  std::vector<int> index(static_cast<std::size_t>(k), -1);
  leading = WideMatrix::Zero(k, k);
  for (Eigen::Index i = 0; i < k; ++i)
    for (std::size_t j = 0; j < markov.size() && index[static_cast<std::size_t>(i)] < 0; ++j) {
      if (markov[j].row(i).isZero(0)) continue;
      index[static_cast<std::size_t>(i)] = static_cast<int>(j);
      leading.row(i) = markov[j].row(i);
    }
  return index;
}

/// A vector with a bound of its error.
struct Value {
  WideVector v, error;
};

}  // namespace

/// One problem, with the solutions found so far.
class CascadeSteps {
 public:
  CascadeSteps(const Cascade& cascade, const Vector& x, double noise, bool impulsive) : c_(cascade), k_(cascade.k_), impulsive_(impulsive) {
    const int deepest = *std::max_element(c_.row_index_.begin(), c_.row_index_.end());
    // Step −max ρ − 1 has nothing known; that u = 0 is its only solution is all that it has to tell.
    first_ = impulsive ? -deepest - 1 : 0;
    x_ = x.cast<Wide>();
    WideVector power = x_;
    WideVector bound = x_.cwiseAbs();
    WideVector error = noise * (bound.array() + share_of_norm * x_.norm()).matrix();
    const WideMatrix size_a = c_.a_.cwiseAbs();
    const WideMatrix size_c = c_.c_.cwiseAbs();
    for (int j = 0; j <= c_.n_ + deepest; ++j) {
      free_.push_back({c_.c_ * power, size_c * (error + sum_rounding * bound)});
      power = c_.a_ * power;
      error = size_a * error;
      bound = size_a * bound;
    }
  }

  CascadeOutcome run() {
    CascadeOutcome outcome;
    if (std::any_of(c_.row_index_.begin(), c_.row_index_.end(), [](int rho) { return rho < 0; })) {
      outcome.verdict = Verdict::undecided;
      return outcome;
    }
    std::vector<Branch> branches(1);
    branches[0].side.assign(static_cast<std::size_t>(k_), Side::undetermined);
    if (!impulsive_ && !start_smoothly(branches[0])) return outcome;
    for (int l = first_; l < std::max(c_.n_, 1) && !branches.empty(); ++l) {
      std::vector<Branch> next;
      for (const Branch& branch : branches) step(branch, l, next);
      branches = std::move(next);
    }
    for (const Branch& branch : branches) outcome.continuations.push_back(continuation(branch));
    outcome.verdict = undecided_             ? Verdict::undecided
                      : branches.empty()     ? Verdict::none
                      : branches.size() == 1 ? Verdict::unique
                                             : Verdict::several;
    return outcome;
  }

 private:
  struct Branch {
    std::vector<Side> side;
    std::vector<Value> u;  ///< from l = first_ on
  };
  /// The complementarity problem of one step, eq. (3.29), and what gives u_I from u_K, eq. (3.25).
  struct Step {
    std::vector<int> active, open;
    WideMatrix inverse;  ///< N_II⁻¹
    Value z;             ///< of eq. (3.22)
    WideMatrix schur;
    Value right;
  };

  [[nodiscard]] std::vector<int> with_side(const Branch& branch, Side side) const {
    std::vector<int> set;
    for (int i = 0; i < k_; ++i)
      if (branch.side[static_cast<std::size_t>(i)] == side) set.push_back(i);
    return set;
  }

  /// Eq. (3.19): false if some y_i begins with a negative coefficient that u cannot change.
  bool start_smoothly(Branch& branch) const {
    for (int i = 0; i < k_; ++i)
      for (int j = 0; j < c_.row_index_[static_cast<std::size_t>(i)]; ++j) {
        const Value& y = free_[static_cast<std::size_t>(j)];
        if (std::abs(y.v[i]) <= y.error[i]) continue;
        if (y.v[i] < 0) return false;
        branch.side[static_cast<std::size_t>(i)] = Side::inactive;
        break;
      }
    return true;
  }

  [[nodiscard]] Value known_part(const Branch& branch, int l) const {
    Value z{WideVector::Zero(k_), WideVector::Zero(k_)};
    for (int i = 0; i < k_; ++i) {
      const int j = c_.row_index_[static_cast<std::size_t>(i)] + l;
      if (j >= 0) {
        z.v[i] = free_[static_cast<std::size_t>(j)].v[i];
        z.error[i] = free_[static_cast<std::size_t>(j)].error[i];
      }
      for (int m = first_; m < l && m <= j; ++m) {
        const auto row = c_.markov_[static_cast<std::size_t>(j - m)].row(i);
        const Value& u = branch.u[static_cast<std::size_t>(m - first_)];
        z.v[i] += row.dot(u.v);
        z.error[i] += row.cwiseAbs().dot(u.error + sum_rounding * u.v.cwiseAbs());
      }
    }
    return z;
  }

  void step(const Branch& branch, int l, std::vector<Branch>& next) {
    Step s;
    s.active = with_side(branch, Side::active);
    s.open = with_side(branch, Side::undetermined);
    s.z = known_part(branch, l);
    const WideMatrix& n = c_.leading_rows_;
    const ScaledBlock block{WideMatrix(n(s.active, s.active))};
    if (!block.regular()) {
      undecided_ = true;
      return;
    }
    s.inverse = block.inverse();
    const WideMatrix through = n(s.open, s.active) * s.inverse;
    s.schur = linalg::wide_clean_sum(n(s.open, s.open), through, -WideMatrix(n(s.active, s.open)));
    s.right.v = s.z.v(s.open) - through * s.z.v(s.active);
    s.right.error = s.z.error(s.open) + through.cwiseAbs() * (s.z.error(s.active) + sum_rounding * s.z.v(s.active).cwiseAbs());
    for (Eigen::Index i = 0; i < s.right.v.size(); ++i)
      if (std::abs(s.right.v[i]) <= s.right.error[i]) s.right.v[i] = 0;

    if (!by_solver(branch, s, next)) by_enumeration(branch, s, next);
  }

  /// Where N is a P-matrix the problem has one solution; false: not found, or its signs are within rounding.
  bool by_solver(const Branch& branch, const Step& s, std::vector<Branch>& next) {
    if (!c_.one_solution_) return false;
    const lcp::AssessedSolution answer = lcp::solve(s.schur.cast<double>(), s.right.v.cast<double>());
    return answer.status == lcp::Status::solved && follow(branch, s, answer.basis, next);
  }

  void by_enumeration(const Branch& branch, const Step& s, std::vector<Branch>& next) {
    const auto open = static_cast<int>(s.open.size());
    if (open > most_enumerated) {
      undecided_ = true;
      return;
    }
    const std::size_t from = next.size();
    for (unsigned bits = 0; bits < (1U << static_cast<unsigned>(open)); ++bits) {
      const std::vector<int> basis = members(bits, open);
      std::vector<Branch> found;
      if (!follow(branch, s, basis, found)) continue;
      const auto first = next.begin() + static_cast<std::ptrdiff_t>(from);
      if (std::none_of(first, next.end(), [&](const Branch& b) { return same_step(b, found[0]); })) next.push_back(std::move(found[0]));
    }
  }

  /// Two solutions of a step with the same u > 0 are the same, the block of those u being regular.
  static bool same_step(const Branch& a, const Branch& b) {
    const auto positive = [](const Branch& branch, Eigen::Index i) { return branch.u.back().v[i] > branch.u.back().error[i]; };
    for (Eigen::Index i = 0; i < a.u.back().v.size(); ++i)
      if (positive(a, i) != positive(b, i)) return false;
    return true;
  }

  /// u_basis from y_basis = 0 (basis: positions in `open`); appends the branch if no sign is wrong.
  bool follow(const Branch& branch, const Step& s, const std::vector<int>& basis, std::vector<Branch>& next) {
    const ScaledBlock block{WideMatrix(s.schur(basis, basis))};
    if (!block.regular()) {
      if (block.consistent(-s.right.v(basis), s.right.error(basis))) undecided_ = true;
      return false;
    }
    const auto open = static_cast<Eigen::Index>(s.open.size());
    const WideMatrix inverse = block.inverse();
    Value u{WideVector::Zero(open), WideVector::Zero(open)};
    const WideVector of_basis = -(inverse * s.right.v(basis));
    u.v(basis) = of_basis;
    u.error(basis) = inverse.cwiseAbs() * (s.right.error(basis) + sum_rounding * (s.schur(basis, basis).cwiseAbs() * of_basis.cwiseAbs()));
    Value y{s.right.v + s.schur * u.v,
            s.right.error + s.schur.cwiseAbs() * (u.error + sum_rounding * u.v.cwiseAbs()) + sum_rounding * s.right.v.cwiseAbs()};
    for (const int i : basis) y.v[i] = y.error[i] = 0;
    Branch result = branch;
    for (Eigen::Index i = 0; i < open; ++i) {
      if (u.v[i] < -u.error[i] || y.v[i] < -y.error[i]) return false;
      Side& side = result.side[static_cast<std::size_t>(s.open[static_cast<std::size_t>(i)])];
      if (u.v[i] > u.error[i])
        side = Side::active;
      else
        u.v[i] = 0;
      if (y.v[i] > y.error[i]) side = Side::inactive;
    }
    Value all{WideVector::Zero(k_), WideVector::Zero(k_)};
    all.v(s.open) = u.v;
    all.error(s.open) = u.error;
    const WideMatrix coupling = c_.leading_rows_(s.active, s.open);
    const WideVector left = s.z.v(s.active) + coupling * u.v;
    const WideVector size = s.z.v(s.active).cwiseAbs() + coupling.cwiseAbs() * u.v.cwiseAbs();
    all.v(s.active) = -(s.inverse * left);
    all.error(s.active) = s.inverse.cwiseAbs() * (s.z.error(s.active) + coupling.cwiseAbs() * u.error + sum_rounding * size);
    result.u.push_back(std::move(all));
    next.push_back(std::move(result));
    return true;
  }

  [[nodiscard]] Continuation continuation(const Branch& branch) const {
    Continuation result{IndexSet(k_), IndexSet(k_), IndexSet(k_), false, {}};
    for (int i = 0; i < k_; ++i) {
      const Side side = branch.side[static_cast<std::size_t>(i)];
      (side == Side::active ? result.active : side == Side::inactive ? result.inactive : result.indeterminate).set(i, true);
    }
    WideVector after = x_;
    WideMatrix weight = c_.b_;
    for (int l = -1; l >= first_; --l) {
      const Value& u = branch.u[static_cast<std::size_t>(l - first_)];
      result.jumps |= (u.v.cwiseAbs().array() > u.error.array()).any();
      after += weight * u.v;
      weight = c_.a_ * weight;
    }
    result.state_after = after.cast<double>();
    return result;
  }

  const Cascade& c_;
  int k_;
  bool impulsive_;
  bool undecided_ = false;
  int first_ = 0;
  WideVector x_;
  std::vector<Value> free_;  ///< C A^j x
};

Cascade::Cascade(const Matrix& a, const Matrix& b, const Matrix& c, const Matrix& d)
    : n_(static_cast<int>(a.rows())), k_(static_cast<int>(d.rows())) {
  rate_ = static_cast<Wide>(linalg::rate_of(a));
  a_ = a.cast<Wide>() / rate_;
  b_ = b.cast<Wide>() / rate_;
  c_ = c.cast<Wide>();
  markov_.push_back(d.cast<Wide>());
  WideMatrix power = b_;
  WideMatrix bound = b_.cwiseAbs();
  for (int j = 1; j <= 3 * n_ + 1; ++j) {
    markov_.push_back(linalg::wide_cleaned(c_ * power, c_.cwiseAbs() * bound));
    power = a_ * power;
    bound = a_.cwiseAbs() * bound;
  }
  row_index_ = leading_indices(markov_, leading_rows_);
  one_solution_ = k_ <= most_enumerated ? all_minors_positive(leading_rows_) : is_positive_definite(leading_rows_);
}

CascadeOutcome Cascade::smooth(const Vector& x, double noise) const { return solve(x, noise, false); }
CascadeOutcome Cascade::impulsive(const Vector& x, double noise) const { return solve(x, noise, true); }

CascadeOutcome Cascade::solve(const Vector& x, double noise, bool impulsive) const {
  if (k_ == 0) return {Verdict::unique, {{IndexSet(0), IndexSet(0), IndexSet(0), false, x}}};
  return CascadeSteps(*this, x, noise, impulsive).run();
}

}  // namespace pwlsim::model
