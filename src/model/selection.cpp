#include "model/selection.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "lcp/lemke.hpp"

namespace pwlsim::model {

namespace {

/// ‖P x − x‖ below this multiple of a mode's rounding level, against ‖x‖, is no jump.
constexpr double consistency_per_noise = 30.0;
/// Of a state, against the largest there was.
constexpr double state_rounding = 30.0 * 2.220446049250313e-16;
constexpr double series_noise = 3e-14;
constexpr double share_of_norm = 0.1;
constexpr int most_jumps = 20;
constexpr double s_factors[] = {30.0, 1e3, 1e5, 1e7, 1e9, 1e11};
/// Rounding levels of the verification, tried in turn.
constexpr double relaxations[] = {1.0, 1e2, 1e4};
constexpr double trusted_s_factor = 1e5;  ///< a jump is believed from here on without repetition
constexpr double tie_tolerance = 1e-12;
constexpr double regularisation = 1e-8;    ///< of a problem whose diagonal is about 1
constexpr double switch_rank_tolerance = 1e-11;
constexpr double impulse_tolerance = 1e-8;
constexpr double impulse_rank_tolerance = 1e-9;
constexpr std::size_t most_remembered = 6;
constexpr int few_ports = 6;  ///< with so many all modes are tried for further continuations
/// Continuations of two modes differ when a derivative does by this fraction.
constexpr double alike_tolerance = 1e-9;

}  // namespace

Selector::Selector(const System& system, Several several) : system_(system), several_(several) {
  rate_ = linalg::spectral_norm(system.a);
  if (!(rate_ > 0.0)) rate_ = 1.0;
  for (int i = 0; i < system.diodes; ++i) diode_rows_.push_back(i);
  departures_.resize(static_cast<std::size_t>(system.diodes));
  y_.resize(static_cast<std::size_t>(system.size()));
  projected_.resize(static_cast<std::size_t>(system.size()));
}

const Mode& Selector::mode(const IndexSet& set) {
  auto& slot = modes_[set];
  if (!slot) slot = build_mode(system_, set);
  return *slot;
}

void Selector::mark_visited(const Mode& mode) {
  if (mode.visits++ == 0) ++visited_;
}

bool Selector::consistent(const Mode& mode, const double* x, double* projected) const {
  const int size = system_.size();
  if (!mode.constrained) {
    std::copy(x, x + size, projected);
    return true;
  }
  linalg::multiply(mode.projector, x, projected);
  double change = 0.0;
  double norm = 0.0;
  for (int i = 0; i < size; ++i) {
    change += (projected[i] - x[i]) * (projected[i] - x[i]);
    norm += x[i] * x[i];
  }
  const double tolerance = consistency_per_noise * mode.noise * verifier_.relaxation();
  return change <= tolerance * tolerance * norm;
}

/// The same to the rounding of the largest state there was: a state that is small, but there, does not lie in every mode.
bool Selector::strictly_consistent(const Mode& mode, const double* x, double* projected) const {
  if (!consistent(mode, x, projected)) return false;
  double change = 0.0;
  for (int i = 0; i < system_.size(); ++i) change += (projected[i] - x[i]) * (projected[i] - x[i]);
  return std::sqrt(change) <= state_rounding * largest_;
}

bool Selector::accepts(const Mode& mode, const double* x) {
  departures_of_ = &mode;
  if (system_.diodes == 0) return true;
  to_mode(system_, mode, x, y_.data());
  verifier_.departures(mode, y_.data(), diode_rows_, departures_.data());
  // A guard that was seen to cross cannot stay as it is, even where rounding of fast parts hides its slope here; unless nothing else
  // is left, and it was at rest.
  if (trigger_ >= 0 && verifier_.relaxation() == 1.0 && mode.active.contains(trigger_) == trigger_side_ && departures_[static_cast<std::size_t>(trigger_)].order < 0 &&
      mode.guard_norm[trigger_] > 0.0)
    return false;
  return std::none_of(departures_.begin(), departures_.end(), [](const Departure& d) { return d.value < 0.0; });
}

const Mode* Selector::try_without_jump(double* x, const IndexSet& set) {
  const Mode& m = mode(set);
  if (!m.regular || !consistent(m, x, projected_.data()) || !accepts(m, projected_.data())) return nullptr;
  std::copy(projected_.begin(), projected_.end(), x);
  return &m;
}

const Mode* Selector::remembered(double* x, const IndexSet& wanted) {
  const auto found = successors_.find(wanted);
  if (found == successors_.end()) return nullptr;
  for (const Mode* m : found->second) {
    if (!consistent(*m, x, projected_.data()) || !accepts(*m, projected_.data())) continue;
    std::copy(projected_.begin(), projected_.end(), x);
    return m;
  }
  return nullptr;
}

void Selector::remember(const IndexSet& wanted, const Mode& mode) {
  auto& list = successors_[wanted];
  std::erase(list, &mode);
  list.insert(list.begin(), &mode);
  if (list.size() > most_remembered) list.pop_back();
}

/// M(s) = D + Σ C A^{j−1} B s^{−j} and q(s) = Σ C A^j x s^{−j}, every term that is rounding set to zero: uncleaned noise is
/// amplified by a power of s, and s could then be neither large nor small enough.
void Selector::series(const double* x, double s, Problem& problem) {
  const int n = system_.n;
  const int size = system_.size();
  const int k = system_.ports;
  if (markov_.empty() && k > 0) {
    Matrix w = system_.b;
    Matrix bound = w.cwiseAbs();
    const Matrix size_a = system_.a.cwiseAbs();
    const Matrix size_c = system_.c.cwiseAbs();
    for (int j = 0; j <= n; ++j) {
      Matrix term = system_.c * w;
      const Matrix term_bound = size_c * bound;
      for (Eigen::Index i = 0; i < term.size(); ++i)
        if (std::abs(term.data()[i]) <= series_noise * term_bound.data()[i]) term.data()[i] = 0.0;
      markov_.push_back(std::move(term));
      w = system_.a * w / rate_;
      bound = size_a * bound / rate_;
    }
  }
  problem.m = system_.d;
  double power = 1.0 / s;
  for (const Matrix& term : markov_) {
    problem.m += term * power;
    power *= rate_ / s;
  }
  Vector z = Eigen::Map<const Vector>(x, size);
  Vector bound = z.cwiseAbs();
  bound.head(n).array() += share_of_norm * z.head(n).norm();
  const Matrix size_a = system_.a.cwiseAbs();
  const Matrix size_c = system_.c.cwiseAbs();
  const Vector row_norm = system_.c.rowwise().norm();
  problem.q = Vector::Zero(k);
  power = 1.0;
  for (int j = 0; j <= size; ++j) {
    const Vector value = system_.c * z;
    const Vector level = series_noise * (size_c * bound + share_of_norm * z.norm() * row_norm);
    for (int i = 0; i < k; ++i)
      if (std::abs(value[i]) > level[i]) problem.q[i] += value[i] * power;
    z = system_.a * z / rate_;
    bound = size_a * bound / rate_;
    power *= rate_ / s;
  }
}

/// Active switch ports have y = 0 and a free u. They are solved out of the problem where their own block allows it; else u = u⁺ − u⁻ with
/// ±y ≥ 0 keeps the problem complementary (and monotone when it was).
void Selector::without_switches(const IndexSet& wanted, Problem& problem) const {
  std::vector<int> active;
  for (int i = system_.diodes; i < system_.ports; ++i)
    if (wanted.contains(i)) active.push_back(i);
  const auto d = static_cast<Eigen::Index>(system_.diodes);
  const auto a = static_cast<Eigen::Index>(active.size());
  Problem diodes{problem.m.topLeftCorner(d, d), problem.q.head(d)};
  if (a == 0) {
    problem = std::move(diodes);
    return;
  }
  Matrix ss(a, a), sd(a, d), ds(d, a);
  Vector qs(a);
  for (Eigen::Index i = 0; i < a; ++i) {
    const int port = active[static_cast<std::size_t>(i)];
    qs[i] = problem.q[port];
    sd.row(i) = problem.m.row(port).head(d);
    ds.col(i) = problem.m.col(port).head(d);
    for (Eigen::Index j = 0; j < a; ++j) ss(i, j) = problem.m(port, active[static_cast<std::size_t>(j)]);
  }
  Vector scale(a);
  for (Eigen::Index i = 0; i < a; ++i) {
    const double largest = std::max(std::abs(ss(i, i)), 1e-2 * ss.row(i).cwiseAbs().maxCoeff());
    scale[i] = largest > 0.0 ? 1.0 / std::sqrt(largest) : 1.0;
  }
  const Matrix scaled = scale.asDiagonal() * ss * scale.asDiagonal();
  Eigen::FullPivLU<Matrix> lu(scaled);
  lu.setThreshold(switch_rank_tolerance);
  if (!lu.isInvertible()) {
    problem.m.resize(d + 2 * a, d + 2 * a);
    problem.m << diodes.m, ds, -ds, sd, ss, -ss, -sd, -ss, ss;
    problem.q.resize(d + 2 * a);
    problem.q << diodes.q, qs, -qs;
    return;
  }
  // A Schur complement cancels: what is left of equal terms is rounding, and must not decide.
  const Matrix to = ds * scale.asDiagonal();
  const Matrix inverse = lu.inverse();
  const Matrix left = to * inverse;
  const Matrix left_bound = to.cwiseAbs() * inverse.cwiseAbs();
  const Matrix right = scale.asDiagonal() * sd;
  const Vector right_q = scale.asDiagonal() * qs;
  problem.m = linalg::cleaned(diodes.m - left * right, diodes.m.cwiseAbs() + left_bound * right.cwiseAbs());
  problem.q = linalg::cleaned(diodes.q - left * right_q, diodes.q.cwiseAbs() + left_bound * right_q.cwiseAbs());
}

std::vector<IndexSet> Selector::candidates(const IndexSet& wanted, const Problem& problem) {
  const auto k = problem.q.size();
  Vector scale(k);
  for (Eigen::Index i = 0; i < k; ++i) {
    const double largest = std::max(std::abs(problem.m(i, i)), 1e-2 * problem.m.row(i).cwiseAbs().maxCoeff());
    scale[i] = largest > 0.0 ? 1.0 / std::sqrt(largest) : 1.0;
  }
  const Vector q = scale.asDiagonal() * problem.q;
  const Matrix scaled = scale.asDiagonal() * problem.m * scale.asDiagonal();
  lcp::Solution solution = lcp::lemke(scaled, q);
  pivots_ += static_cast<std::uint64_t>(solution.pivots);
  if (solution.status != lcp::Status::solved) {
    // Rounding of a singular problem (series and parallel diodes) can leave it without a solution; a small multiple of 1 restores one.
    solution = lcp::lemke(scaled + regularisation * Matrix::Identity(k, k), q);
    pivots_ += static_cast<std::uint64_t>(solution.pivots);
  }
  if (solution.status != lcp::Status::solved) return {};
  const double tie = tie_tolerance * (k > 0 ? q.cwiseAbs().maxCoeff() : 0.0);
  IndexSet by_value = wanted;
  IndexSet by_basis = wanted;
  for (int i = 0; i < system_.diodes; ++i) {
    const bool tied = solution.z[i] <= tie && solution.w[i] <= tie;
    if (!tied) by_value.set(i, solution.z[i] > solution.w[i]);
    by_basis.set(i, false);
  }
  for (const int i : solution.basis)
    if (i < system_.diodes) by_basis.set(i, true);
  if (by_value == by_basis) return {by_value};
  return {by_value, by_basis};
}

/// First-order impulses u = μδ must push the way complementarity allows: x⁺ − x⁻ = B_J μ and D_JJ μ = 0 with μ ≥ 0 on active diodes,
/// and D_iJ μ ≥ 0, the impulse of y, on the others. Where μ is not unique, the least.
bool Selector::impulse_allowed(const Mode& m, const double* x, const Vector& jump) {
  const auto size = static_cast<Eigen::Index>(system_.size());
  std::vector<int> active;
  for (int i = 0; i < system_.ports; ++i)
    if (m.active.contains(i)) active.push_back(i);
  const auto q = static_cast<Eigen::Index>(active.size());
  // In units of √rate the columns of B and of D are of one size.
  const double root = std::sqrt(rate_);
  Matrix effect(size + q, q);
  Vector scale(q);
  for (Eigen::Index i = 0; i < q; ++i) {
    const int port = active[static_cast<std::size_t>(i)];
    effect.col(i).head(size) = system_.b.col(port) / root;
    for (Eigen::Index j = 0; j < q; ++j) effect(size + j, i) = system_.d(active[static_cast<std::size_t>(j)], port);
    const double norm = effect.col(i).norm();
    scale[i] = norm > 0.0 ? 1.0 / norm : 1.0;
    effect.col(i) *= scale[i];
  }
  Vector wanted = Vector::Zero(size + q);
  wanted.head(size) = jump / root;
  Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition;
  decomposition.setThreshold(impulse_rank_tolerance);  // before compute(), which leaves undone what its rank does not call for
  decomposition.compute(effect);
  const Vector scaled = decomposition.solve(wanted);
  // A small jump is the difference of large states.
  const double tolerance = impulse_tolerance + m.noise * linalg::norm(x, size) / jump.norm();
  const bool first_order = (effect * scaled - wanted).norm() <= tolerance * wanted.norm();
  // The effect on x was divided by the root, that on y was not.
  impulse_ = Vector::Zero(system_.ports);
  for (Eigen::Index i = 0; i < q; ++i) impulse_[active[static_cast<std::size_t>(i)]] = scale[i] * scaled[i];
  const Vector& impulse = impulse_;
  impulse_is_higher_ = !first_order;
  if (!first_order) return true;
  const Vector response = system_.d * impulse;
  const double least_impulse = -tolerance * impulse.cwiseAbs().maxCoeff();
  const double least_response = least_impulse * system_.d.cwiseAbs().maxCoeff();
  for (int i = 0; i < system_.diodes; ++i)
    if (m.active.contains(i) ? impulse[i] < least_impulse : response[i] < least_response) return false;
  return true;
}

const Mode* Selector::from_rcp(double* x, const IndexSet& wanted, bool& jumped) {
  const int size = system_.size();
  jumped = false;
  const Mode* previous = nullptr;
  for (const double factor : s_factors) {
    Problem problem;
    series(x, rate_ * factor, problem);
    without_switches(wanted, problem);
    if (!problem.m.allFinite() || !problem.q.allFinite()) continue;
    const Mode* first_jump = nullptr;
    for (const IndexSet& set : candidates(wanted, problem)) {
      const Mode& m = mode(set);
      if (!m.regular) continue;
      if (consistent(m, x, projected_.data())) {
        if (!accepts(m, projected_.data())) continue;
        std::copy(projected_.begin(), projected_.end(), x);
        return &m;
      }
      const Vector jump = Eigen::Map<const Vector>(projected_.data(), size) - Eigen::Map<const Vector>(x, size);
      if (!impulse_allowed(m, x, jump)) continue;
      if (&m == previous || factor >= trusted_s_factor) {
        // Once more: what the rounding of P leaves outside of V is in proportion to the state before, which may have been far larger.
        linalg::multiply(m.projector, projected_.data(), x);
        jumped = true;
        return &m;
      }
      if (!first_jump) first_jump = &m;
    }
    previous = first_jump;
  }
  return nullptr;
}

const Mode* Selector::from_neighbourhood(double* x, const IndexSet& wanted, int radius) {
  const int k = system_.diodes;
  IndexSet set = wanted;
  for (int i = 0; i < k; ++i) {
    set.flip(i);
    if (const Mode* m = try_without_jump(x, set)) return m;
    for (int j = i + 1; radius > 1 && j < k; ++j) {
      set.flip(j);
      if (const Mode* m = try_without_jump(x, set)) return m;
      for (int l = j + 1; radius > 2 && l < k; ++l) {
        set.flip(l);
        if (const Mode* m = try_without_jump(x, set)) return m;
        set.flip(l);
      }
      set.flip(j);
    }
    set.flip(i);
  }
  return nullptr;
}

/// Two verified modes are one solution if x departs alike and Δu_i·Δy_i = 0 at every port: then only what no power tells apart
/// differs (the split between parallel diodes, the potential of a floating part).
bool Selector::continues_alike(const Mode& a, const Mode& b, const double* x) const {
  const Vector start = Eigen::Map<const Vector>(x, system_.size());
  Vector za = start, zb = start, moved(start.size());
  Vector ua(system_.ports), ub(system_.ports), ya(system_.ports), dy(system_.ports);
  const auto differentiate = [&](Vector& z, const Vector& u) {
    linalg::multiply(system_.a, z.data(), moved.data());
    linalg::multiply(system_.b, u.data(), z.data());
    z = (z + moved) / rate_;
  };
  double size = start.norm();
  for (int j = 0; j <= system_.size(); ++j) {
    if ((za - zb).norm() > alike_tolerance * size) return false;
    linalg::multiply(a.k, za.data(), ua.data());
    linalg::multiply(b.k, zb.data(), ub.data());
    linalg::multiply(system_.c, za.data(), ya.data());
    const double port_size = std::max({ua.cwiseAbs().maxCoeff(), ub.cwiseAbs().maxCoeff(), ya.cwiseAbs().maxCoeff()});
    moved = za - zb;
    linalg::multiply(system_.c, moved.data(), dy.data());
    const Vector du = ua - ub;
    linalg::multiply(system_.d, du.data(), ya.data());
    dy += ya;
    for (int i = 0; i < system_.ports; ++i)
      if (std::min(std::abs(du[i]), std::abs(dy[i])) > alike_tolerance * port_size) return false;
    differentiate(za, ua);
    differentiate(zb, ub);
    size = std::max({size * 1e-3, za.norm(), zb.norm()});
  }
  return true;
}

/// Where no certificate promises uniqueness: the verified modes that continue differently, one of each kind, `chosen` among them. All
/// modes are tried where there are few, else those near the chosen one.
std::vector<const Mode*> Selector::continuations(const double* x, const Mode& chosen) {
  const int k = system_.diodes;
  const std::vector<double> copy(x, x + system_.size());
  std::vector<const Mode*> found{&chosen};
  const auto try_set = [&](const IndexSet& set) {
    const Mode& m = mode(set);
    if (&m == &chosen || !m.regular || !strictly_consistent(m, copy.data(), projected_.data()) || !accepts(m, projected_.data())) return;
    if (std::none_of(found.begin(), found.end(), [&](const Mode* other) { return continues_alike(*other, m, copy.data()); })) found.push_back(&m);
  };
  IndexSet set = chosen.active;
  if (k <= few_ports) {
    for (unsigned bits = 0; bits < (1U << k); ++bits) {
      for (int i = 0; i < k; ++i) set.set(i, (bits >> i) & 1U);
      try_set(set);
    }
    return found;
  }
  for (int i = 0; i < k; ++i) {
    set.flip(i);
    try_set(set);
    for (int j = i + 1; j < k; ++j) {
      set.flip(j);
      try_set(set);
      set.flip(j);
    }
    set.flip(i);
  }
  return found;
}

/// Of several: the first has u = 0 in the earliest port in which they differ.
const Mode* Selector::first_of(const std::vector<const Mode*>& modes) const {
  return *std::min_element(modes.begin(), modes.end(), [&](const Mode* a, const Mode* b) {
    for (int i = 0; i < system_.diodes; ++i)
      if (a->active.contains(i) != b->active.contains(i)) return b->active.contains(i);
    return false;
  });
}

/// Ports with u = 0 whose y is zero in this mode whatever x is: the same trajectory has them active too, and their share is then
/// decided by least norm (parallel diodes) instead of by the order of pivots.
const Mode* Selector::with_free_ports(double* x, const Mode& found) {
  const bool is_new = enriched_.try_emplace(&found, nullptr).second;
  if (is_new) {
    IndexSet set = found.active;
    bool any = false;
    for (int i = 0; i < system_.diodes; ++i)
      if (found.guard_norm[i] == 0.0 && !set.contains(i)) {
        set.set(i, true);
        any = true;
      }
    const Mode* richer = any ? &mode(set) : nullptr;
    enriched_[&found] = richer && richer->regular ? richer : nullptr;
  }
  const Mode* richer = enriched_[&found];
  if (!richer || !consistent(*richer, x, projected_.data()) || !accepts(*richer, projected_.data())) return &found;
  std::copy(projected_.begin(), projected_.end(), x);
  return richer;
}

/// The set after the port has changed sides, and with it those that share its guard (diodes in series).
IndexSet Selector::with_flipped(const IndexSet& set, int port) const {
  IndexSet flipped = set;
  flipped.flip(port);
  const auto before = modes_.find(set);
  if (before == modes_.end() || before->second->guard_twin.empty()) return flipped;
  const auto& twin = before->second->guard_twin;
  for (int i = 0; i < system_.diodes; ++i)
    if (i != port && twin[static_cast<std::size_t>(i)] == twin[static_cast<std::size_t>(port)]) flipped.flip(i);
  return flipped;
}

const Mode* Selector::search(double* x, const IndexSet& current, int trigger, bool& warm, bool& jumped) {
  // In a passive system the state that follows is unique, so any verified mode will do, and what followed last time comes first.
  const Mode* found = system_.passive ? remembered(x, current) : nullptr;
  warm = found != nullptr;
  if (!found) {
    found = try_without_jump(x, current);
    warm = found && !(system_.passive && successors_.contains(current));
  }
  if (!found && !system_.passive) found = remembered(x, current);
  if (!found && trigger >= 0 && trigger < system_.diodes) {
    found = try_without_jump(x, with_flipped(current, trigger));
  }
  if (!found) found = from_rcp(x, current, jumped);
  if (!found) found = from_neighbourhood(x, current, system_.diodes <= 12 ? 3 : 2);
  return found;
}

Selected Selector::select(double* x, const IndexSet& wanted, int trigger) {
  Selected result;
  IndexSet current = wanted;
  largest_ = std::max(largest_, linalg::norm(x, system_.size()));
  trigger_ = trigger < system_.diodes ? trigger : -1;
  trigger_side_ = trigger_ >= 0 && wanted.contains(trigger_);
  while (result.jumps <= most_jumps) {
    const Mode* found = nullptr;
    bool warm = false;
    bool jumped = false;
    // Two guards that reach zero within rounding of each other can each, by the other's rounding, look as if it had gone first.
    // Then no mode passes; a coarser level calls them one event, at an error of the state of that level.
    for (const double level : relaxations) {
      verifier_.relax(level, largest_);
      found = search(x, current, result.jumps == 0 ? trigger : -1, warm, jumped);
      if (found) break;
    }
    result.relaxation = verifier_.relaxation();
    if (!found) {
      result.choice = Choice::none;
      result.mode = &mode(current);
      return result;
    }
    if (jumped) {
      ++result.jumps;
      if (result.impulse.size() == 0) result.impulse = impulse_;
      else result.impulse += impulse_;
      result.higher_order |= impulse_is_higher_;
      trigger_ = -1;
      current = found->active;
      continue;
    }
    if (!warm) remember(current, *found);
    found = with_free_ports(x, *found);
    result.mode = found;
    if (system_.passive || system_.diodes == 0) return result;
    result.continuations = continuations(x, *found);
    if (result.continuations.size() == 1) return result;
    result.choice = Choice::several;
    if (several_ == Several::first) result.mode = first_of(result.continuations);
    if (result.mode != found && strictly_consistent(*result.mode, x, projected_.data())) std::copy(projected_.begin(), projected_.end(), x);
    return result;
  }
  result.choice = Choice::too_many_jumps;
  result.mode = &mode(current);
  return result;
}

}  // namespace pwlsim::model
