/// The estimated error of exact segments, and its bound, beside the true one, on random passive networks.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "engine/sparse/exact_segment.hpp"
#include "support/circuit.hpp"
#include "support/random.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using namespace pwlsim::engine::sparse;

namespace {

__extension__ using Quad = __float128;

/// A square matrix, column after column.
template <class Real>
struct Square {
  int size;
  std::vector<Real> entries;

  explicit Square(int n) : size(n), entries(static_cast<std::size_t>(n * n), Real(0)) {}
  template <class Other>
  Square(const Square<Other>& other, Real factor) : size(other.size) {
    for (const Other& entry : other.entries) entries.push_back(static_cast<Real>(entry) * factor);
  }
  [[nodiscard]] Real& operator()(int i, int j) { return entries[static_cast<std::size_t>(j * size + i)]; }
  [[nodiscard]] const Real& operator()(int i, int j) const { return entries[static_cast<std::size_t>(j * size + i)]; }
  /// The largest sum of magnitudes of a row.
  [[nodiscard]] double norm() const {
    double most = 0.0;
    for (int i = 0; i < size; ++i) {
      double sum = 0.0;
      for (int j = 0; j < size; ++j) sum += std::abs(static_cast<double>((*this)(i, j)));
      most = std::max(most, sum);
    }
    return most;
  }
  [[nodiscard]] Real* column(int j) { return &entries[static_cast<std::size_t>(j * size)]; }
  [[nodiscard]] const Real* column(int j) const { return &entries[static_cast<std::size_t>(j * size)]; }
  void multiply(const Real* x, Real* y) const {
    std::fill(y, y + size, Real(0));
    for (int j = 0; j < size; ++j)
      if (x[j] != Real(0))
        for (int i = 0; i < size; ++i) y[i] += column(j)[i] * x[j];
  }
  [[nodiscard]] Square times(const Square& other) const {
    Square product = other;
    for (int j = 0; j < size; ++j) multiply(other.column(j), product.column(j));
    return product;
  }
};

/// e^A, by terms of its series after so many halvings that it is below 1/4, and squared as often. Rounding grows as ‖A‖.
template <class Real>
Square<Real> exponential(const Square<Quad>& a, double time) {
  constexpr int terms = 18;  // 4^−18/18! < 3e-27
  const int halved = std::max(0, static_cast<int>(std::ceil(std::log2(a.norm() * time))) + 2);
  const Square<Real> small(a, static_cast<Real>(std::ldexp(time, -halved)));
  Square<Real> sum(a.size);
  for (int i = 0; i < a.size; ++i) sum(i, i) = 1;
  for (int k = terms; k > 0; --k) {
    sum = small.times(sum);
    for (Real& entry : sum.entries) entry /= static_cast<Real>(k);
    for (int i = 0; i < a.size; ++i) sum(i, i) += 1;
  }
  for (int k = 0; k < halved; ++k) sum = sum.times(sum);
  return sum;
}

/// e^{A τ} x at τ = length·2^−halvings, doubled until length.
template <class Real>
std::vector<std::vector<Quad>> motion_by(const Square<Quad>& a, const std::vector<Quad>& start, double length, int halvings) {
  Square<Real> flow = exponential<Real>(a, std::ldexp(length, -halvings));
  std::vector<Real> x, y(start.size());
  for (const Quad value : start) x.push_back(static_cast<Real>(value));
  std::vector<std::vector<Quad>> points;
  for (int k = halvings; k >= 0; --k) {
    flow.multiply(x.data(), y.data());
    points.emplace_back(y.begin(), y.end());
    if (k > 0) flow = flow.times(flow);
  }
  return points;
}

/// The same to 1e-15 of what it moves.
std::vector<std::vector<Quad>> true_motion(const Square<Quad>& a, const std::vector<Quad>& start, double length, int halvings) {
  constexpr double largest = 1e4;
  return length * a.norm() < largest ? motion_by<long double>(a, start, length, halvings) : motion_by<Quad>(a, start, length, halvings);
}

/// A = F Fᵀ, F lower triangular.
Square<Quad> cholesky(const Square<Quad>& a) {
  Square<Quad> f(a.size);
  for (int j = 0; j < a.size; ++j)
    for (int i = j; i < a.size; ++i) {
      Quad rest = a(i, j);
      for (int k = 0; k < j; ++k) rest -= f(i, k) * f(j, k);
      if (i > j) {
        f(i, j) = rest / f(j, j);
        continue;
      }
      Quad root = std::sqrt(static_cast<double>(rest));
      for (int round = 0; round < 3; ++round) root = (root + rest / root) / 2;
      f(j, j) = root;
    }
  return f;
}

/// x := F⁻¹ x, or F⁻ᵀ x.
void solve_lower(const Square<Quad>& f, Quad* x) {
  for (int i = 0; i < f.size; ++i) {
    for (int k = 0; k < i; ++k) x[i] -= f(i, k) * x[k];
    x[i] /= f(i, i);
  }
}
void solve_upper(const Square<Quad>& f, Quad* x) {
  for (int i = f.size - 1; i >= 0; --i) {
    for (int k = i + 1; k < f.size; ++k) x[i] -= f(k, i) * x[k];
    x[i] /= f(i, i);
  }
}

/// A passive network without ports, and its motion by Kirchhoff's laws, in 113 bits. Every node has a capacitor to ground; others, resistors, inductors and sources of current are between nodes.
/// A node may be held by a source of voltage: a loop of it and capacitors. Inductors may be coupled, or two in series with nothing else between them: a cutset of inductors.
///
/// Unknowns of the motion: Fᵀ v of the nodes that are not held, with F Fᵀ their capacitances, the same of currents, and 1, the sine and cosine, and a ramp.
class RandomMotion {
 public:
  explicit RandomMotion(std::uint64_t seed);

  TestCircuit circuit;
  double length = 0.0;
  [[nodiscard]] std::vector<std::vector<Quad>> truth(double end, int halvings) const { return true_motion(a_, start_, end, halvings); }
  [[nodiscard]] const std::vector<Quad>& start() const { return start_; }
  /// Of capacitors and inductors in their order.
  [[nodiscard]] std::vector<double> states(const std::vector<Quad>& x) const;
  /// Of states, twice their energy, J.
  [[nodiscard]] double energy(const std::vector<double>& states) const;

 private:
  static constexpr int sources = 4;
  using OfSources = std::array<Quad, sources>;
  struct Capacitor {
    int p, n;
    double farads;
  };
  struct Coil {
    int p, n;
    double henries;
    int second = -1;     ///< of two in series, the other one
    double other = 0.0;  ///< its inductance
    double mutual = 0.0;
  };
  [[nodiscard]] double spread(double low, double high) { return low * std::pow(high / low, random_.unit()); }
  static std::string name(int node) { return node < 0 ? "0" : "n" + std::to_string(node); }
  [[nodiscard]] std::pair<int, int> pair();
  void capacitor(int p, int n, double farads);
  void resistor(int p, int n, double ohms);
  void coil();
  void couple();
  void inject();
  void hold();
  void assemble();
  void begin();
  [[nodiscard]] Quad held_voltage(const Quad* zeta) const;

  Random random_;
  int nodes_ = 0;
  double wide_ = 1.0, frequency_ = 0.0;
  std::vector<Capacitor> capacitors_;
  std::vector<Coil> coils_;
  struct Mutual {
    int a, b;
    double henries;
  };
  std::vector<Mutual> mutual_;  ///< of coils in the motion
  int inductors_ = 0;           ///< in the circuit
  std::vector<int> first_;      ///< inductor of each coil
  int held_ = -1;               ///< node
  OfSources voltage_{}, slopes_{};
  Square<Quad> capacitance_{0}, conductance_{0}, inductance_{0}, roots_{0}, coil_roots_{0};
  std::vector<OfSources> injected_;
  std::vector<int> free_;
  Square<Quad> a_{0};
  std::vector<Quad> start_;
};

std::pair<int, int> RandomMotion::pair() {
  const int p = random_.whole(0, nodes_ - 1);
  const int n = (p + random_.whole(1, nodes_)) % (nodes_ + 1) - 1;  // −1: ground
  return {p, n == p ? -1 : n};
}

void stamp(Square<Quad>& matrix, int p, int n, Quad value) {
  if (p >= 0) matrix(p, p) += value;
  if (n >= 0) matrix(n, n) += value;
  if (p < 0 || n < 0) return;
  matrix(p, n) -= value;
  matrix(n, p) -= value;
}

void RandomMotion::capacitor(int p, int n, double farads) {
  circuit.c(name(p), name(n), farads);
  capacitors_.push_back({p, n, farads});
  stamp(capacitance_, p, n, farads);
}

void RandomMotion::resistor(int p, int n, double ohms) {
  circuit.r(name(p), name(n), ohms);
  stamp(conductance_, p, n, Quad(1) / ohms);
}

void RandomMotion::coil() {
  const auto [p, n] = pair();
  Coil coil{p, n, 1e-3 * spread(1.0 / wide_, wide_)};
  first_.push_back(inductors_);
  if (random_.chance(0.2)) {
    const std::string between = "m" + std::to_string(inductors_);
    coil.other = coil.henries * spread(0.1, 10.0);
    const int first = circuit.l(name(p), between, coil.henries);
    coil.second = circuit.l(between, name(n), coil.other);
    ++inductors_;
    if (random_.chance(0.5)) {
      const double k = random_.between(-0.9, 0.9);
      circuit.k(first, coil.second, k);
      coil.mutual = k * std::sqrt(coil.henries * coil.other);
    }
  } else {
    circuit.l(name(p), name(n), coil.henries);
  }
  ++inductors_;
  coils_.push_back(coil);
}

/// Some that are beside one another in the list.
void RandomMotion::couple() {
  for (int i = 0; i + 1 < static_cast<int>(coils_.size()); ++i) {
    const auto& a = coils_[static_cast<std::size_t>(i)];
    const auto& b = coils_[static_cast<std::size_t>(i) + 1];
    if (a.second >= 0 || b.second >= 0 || !random_.chance(0.3)) continue;
    const double k = random_.between(-0.45, 0.45);  // three in a row stay positive
    circuit.k(first_[static_cast<std::size_t>(i)], first_[static_cast<std::size_t>(i) + 1], k);
    mutual_.push_back({i, i + 1, k * std::sqrt(a.henries * b.henries)});
  }
}

void RandomMotion::inject() {
  const auto amperes = [&] { return 1e-3 * random_.between(-1.0, 1.0); };
  const auto add = [&](int source, double value, const model::SourceFunction& function) {
    const int at = random_.whole(0, nodes_ - 1);
    circuit.i("0", name(at), function);
    injected_[static_cast<std::size_t>(at)][static_cast<std::size_t>(source)] += value;
  };
  if (const double value = amperes(); random_.chance(0.6)) add(0, value, model::Dc{value});
  if (const double value = amperes(); random_.chance(0.6)) add(1, value, sine(value, frequency_));
  if (const double value = amperes(); random_.chance(0.4)) add(3, value, model::Pwl{{{0.0, 0.0}, {128.0 * length, 128.0 * value}}});
}

void RandomMotion::hold() {
  held_ = random_.whole(0, nodes_ - 1);
  const double offset = random_.between(-1.0, 1.0), amplitude = random_.between(-1.0, 1.0);
  const bool is_ramp = random_.chance(0.3);
  voltage_[0] = offset;
  voltage_[is_ramp ? 3 : 1] = amplitude;
  if (is_ramp) {
    circuit.v(name(held_), "0", model::Pwl{{{0.0, offset}, {128.0 * length, offset + 128.0 * amplitude}}});
  } else {
    model::Sin source = sine(amplitude, frequency_);
    source.offset = offset;
    circuit.v(name(held_), "0", source);
  }
}

RandomMotion::RandomMotion(std::uint64_t seed) : random_(seed) {
  nodes_ = random_.whole(2, 12);
  const int coils = random_.whole(0, nodes_ - 1);
  wide_ = std::pow(10.0, 0.5 * random_.between(0.5, 6.0));
  length = 1e-6 * spread(1e-2, 1e2);
  frequency_ = spread(1e-2, 10.0) / length;
  capacitance_ = conductance_ = Square<Quad>(nodes_);
  injected_.resize(static_cast<std::size_t>(nodes_));
  for (int i = 0; i < nodes_; ++i) capacitor(i, -1, 1e-9 * spread(1.0 / wide_, wide_));
  for (int i = 0; i < nodes_; ++i)
    if (random_.chance(0.8)) resistor(i, i - 1, 1e3 * spread(1.0 / wide_, wide_));
  for (int i = 0; i < nodes_; ++i) {
    const auto [p, n] = pair();
    if (random_.chance(0.2))
      capacitor(p, n, 1e-9 * spread(1.0 / wide_, wide_));
    else
      resistor(p, n, 1e3 * spread(1.0 / wide_, wide_));
  }
  for (int k = 0; k < coils; ++k) coil();
  couple();
  inject();
  if (random_.chance(0.3)) hold();
  assemble();
  begin();
}

/// Rows of  F⁻¹ (…)  of Kirchhoff's laws at the nodes that are not held, and of Faraday's.
void RandomMotion::assemble() {
  for (int i = 0; i < nodes_; ++i)
    if (i != held_) free_.push_back(i);
  const int v = static_cast<int>(free_.size()), k = static_cast<int>(coils_.size()), size = v + k + sources;
  Square<Quad> c(v), l(k);
  for (int i = 0; i < v; ++i)
    for (int j = 0; j < v; ++j) c(i, j) = capacitance_(free_[static_cast<std::size_t>(i)], free_[static_cast<std::size_t>(j)]);
  for (int i = 0; i < k; ++i) {
    const Coil& coil = coils_[static_cast<std::size_t>(i)];
    l(i, i) = Quad(coil.henries) + coil.other + 2 * Quad(coil.mutual);
  }
  for (const Mutual& m : mutual_) l(m.a, m.b) = l(m.b, m.a) = m.henries;
  roots_ = cholesky(c);
  coil_roots_ = cholesky(l);
  Square<Quad> rates(size);  // by voltages and currents, and the sources
  const Quad omega = 2 * static_cast<Quad>(std::numbers::pi) * frequency_;
  const int one = v + k;
  rates(one + 1, one + 2) = omega;
  rates(one + 2, one + 1) = -omega;
  rates(one + 3, one) = Quad(1) / length;
  OfSources derivative{};  // of the voltage that is held
  derivative[0] = voltage_[3] / length;
  derivative[2] = voltage_[1] * omega;
  for (int i = 0; i < v; ++i) {
    const int node = free_[static_cast<std::size_t>(i)];
    for (int j = 0; j < v; ++j) rates(i, j) = -conductance_(node, free_[static_cast<std::size_t>(j)]);
    for (int s = 0; s < sources; ++s) {
      const auto at = static_cast<std::size_t>(s);
      rates(i, one + s) = injected_[static_cast<std::size_t>(node)][at];
      if (held_ >= 0) rates(i, one + s) -= conductance_(node, held_) * voltage_[at] + capacitance_(node, held_) * derivative[at];
    }
  }
  const auto place = [&](int node) { return node - (held_ >= 0 && node > held_ ? 1 : 0); };
  for (int j = 0; j < k; ++j)
    for (const auto& [at, sign] : {std::pair{coils_[static_cast<std::size_t>(j)].p, 1}, {coils_[static_cast<std::size_t>(j)].n, -1}}) {
      if (at < 0) continue;
      if (at == held_) {
        for (int s = 0; s < sources; ++s) rates(v + j, one + s) += sign * voltage_[static_cast<std::size_t>(s)];
        continue;
      }
      rates(place(at), v + j) -= sign;
      rates(v + j, place(at)) += sign;
    }
  a_ = Square<Quad>(size);
  for (int j = 0; j < size; ++j) {  // F⁻¹ (…) F⁻ᵀ: first the columns, as those of a vector of motion
    std::vector<Quad> x(static_cast<std::size_t>(size), 0), y(static_cast<std::size_t>(size));
    x[static_cast<std::size_t>(j)] = 1;
    solve_upper(roots_, x.data());
    solve_upper(coil_roots_, x.data() + v);
    rates.multiply(x.data(), y.data());
    solve_lower(roots_, y.data());
    solve_lower(coil_roots_, y.data() + v);
    std::copy(y.begin(), y.end(), a_.column(j));
  }
}

void RandomMotion::begin() {
  const int v = static_cast<int>(free_.size()), k = static_cast<int>(coils_.size());
  start_.assign(static_cast<std::size_t>(a_.size), 0);
  const bool rests = random_.chance(0.2);
  for (int i = 0; i < v && !rests; ++i) {
    const Quad value = random_.chance(0.3) ? 0.0 : random_.between(-1.0, 1.0);
    for (int j = 0; j <= i; ++j) start_[static_cast<std::size_t>(j)] += roots_(i, j) * value;
  }
  for (int i = 0; i < k && !rests; ++i) {
    const Quad value = random_.chance(0.3) ? 0.0 : 1e-3 * random_.between(-1.0, 1.0);
    for (int j = 0; j <= i; ++j) start_[static_cast<std::size_t>(v + j)] += coil_roots_(i, j) * value;
  }
  start_[static_cast<std::size_t>(v + k)] = start_[static_cast<std::size_t>(v + k + 2)] = 1;
}

std::vector<double> RandomMotion::states(const std::vector<Quad>& motion) const {
  const auto v = static_cast<int>(free_.size());
  std::vector<Quad> x = motion;
  solve_upper(roots_, x.data());
  solve_upper(coil_roots_, x.data() + v);
  std::vector<Quad> node(static_cast<std::size_t>(nodes_));
  for (std::size_t i = 0; i < free_.size(); ++i) node[static_cast<std::size_t>(free_[i])] = x[i];
  const Quad* zeta = x.data() + v + static_cast<int>(coils_.size());
  for (std::size_t s = 0; s < sources && held_ >= 0; ++s) node[static_cast<std::size_t>(held_)] += voltage_[s] * zeta[s];
  std::vector<double> states;
  const auto at = [&](int i) { return i >= 0 ? node[static_cast<std::size_t>(i)] : Quad(0); };
  for (const Capacitor& c : capacitors_) states.push_back(static_cast<double>(at(c.p) - at(c.n)));
  for (std::size_t j = 0; j < coils_.size(); ++j)
    for (int twice = coils_[j].second >= 0 ? 2 : 1; twice > 0; --twice)
      states.push_back(static_cast<double>(x[static_cast<std::size_t>(v) + j]));
  return states;
}

double RandomMotion::energy(const std::vector<double>& states) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < capacitors_.size(); ++i) sum += capacitors_[i].farads * states[i] * states[i];
  const double* current = states.data() + capacitors_.size();
  for (std::size_t j = 0; j < coils_.size(); ++j) {
    const double* own = current + first_[j];
    sum += coils_[j].henries * own[0] * own[0];
    if (coils_[j].second >= 0) sum += coils_[j].other * own[1] * own[1] + 2.0 * coils_[j].mutual * own[0] * own[1];
  }
  for (const Mutual& m : mutual_)
    sum += 2.0 * m.henries * current[first_[static_cast<std::size_t>(m.a)]] * current[first_[static_cast<std::size_t>(m.b)]];
  return sum;
}

struct Judged {
  double estimate = 0.0, error = 0.0;  ///< of the largest √energy
  int vectors = 0;
  std::vector<ErrorGrowth> bounds;  ///< at length·2^−k
  std::vector<double> errors;
};

/// The first segment of that motion, nothing if it has none.
std::optional<Judged> judge(RandomMotion& motion, double tolerance) {
  const Descriptor descriptor(motion.circuit.network());
  Factors factors(motion.circuit.network(), descriptor);
  Sources sources(motion.circuit.network());
  if (!(sources.next_break() > 0.0)) (void)sources.advance(0.0, 0.0);
  const std::vector<WatchedControl> none;
  ExactSegment segment(descriptor, sources, none, tolerance, 64.0 * motion.length);
  segment.note_least_voltage(1e-3);
  const double r0 = descriptor.r0();
  const auto& states = descriptor.states();
  std::vector<double> values = motion.states(motion.start()), w, z, more;
  for (std::size_t i = 0; i < states.size(); ++i)
    if (states[i].is_current) values[i] *= r0;
  sources.evaluate(0.0, w);
  const Position on;
  (void)descriptor.unknowns_of_states(values, w, on, z, more);
  if (segment.open(factors, {0.0, on, z, {}, motion.length}) != ExactSegment::Opened::yes) return {};
  constexpr int halvings = 8;
  const auto truth = motion.truth(segment.length(), halvings);
  Judged judged{segment.relative_error(), 0.0, static_cast<int>(segment.counts().vectors), {}, {}};
  double largest = segment.size();
  std::vector<double> reached;
  segment.unknowns(segment.at(0.0), reached);
  const double start = segment.start_error(z, reached);
  for (int k = 0; k <= halvings; ++k) {
    const double tau = std::ldexp(segment.length(), k - halvings);
    segment.unknowns(segment.at(tau), reached);
    std::vector<double> difference = motion.states(truth[static_cast<std::size_t>(k)]);
    largest = std::max(largest, std::sqrt(r0 * motion.energy(difference)));
    for (std::size_t i = 0; i < states.size(); ++i)
      difference[i] -= states[i].value(reached.data()) * (states[i].is_current ? 1.0 / r0 : 1.0);
    judged.errors.push_back(std::sqrt(r0 * std::max(0.0, motion.energy(difference))));
    judged.bounds.push_back(segment.error_growth(tau));
    judged.bounds.back().error += start;
  }
  const double scale = segment.size() / largest;
  judged.estimate *= scale;
  for (double& error : judged.errors) error /= largest;
  for (auto& bound : judged.bounds) {
    bound.error /= largest;
    bound.rounding /= largest;
  }
  judged.error = *std::max_element(judged.errors.begin(), judged.errors.end());
  return judged;
}

constexpr double most_tolerances = 10.0;    ///< that an error may be, or estimates where the vectors reach no more: an estimate is no bound
constexpr double full_space_error = 1e-12;  ///< of the largest √energy: a full space is estimated to have no error
constexpr double largest_factor = 10.0, its_share = 0.01,
                 share_far_below = 0.02;  ///< so many errors may be more than that times what they are estimated at

constexpr double reference_rounding = 1e-15;  ///< of the largest √energy
constexpr double most_roundings = 20.0;       ///< that rounding may be: its estimate leaves out what the rounding of sources drives
constexpr double visible = 1e-13;             ///< of it: smaller errors are as much of rounding as of the vectors
constexpr double most_in_median = 100.0;      ///< of errors that are visible, their bounds

struct EstimateTally {
  std::uint64_t judged = 0, far_below = 0, misjudged = 0, unbounded = 0;
  std::vector<double> factors;  ///< bounds over errors
};

void check_segment(const Judged& segment, double tolerance, EstimateTally& tally) {
  ++tally.judged;
  tally.misjudged += segment.error > most_tolerances * std::max(tolerance, segment.estimate) ? 1 : 0;
  tally.far_below += segment.error > largest_factor * std::max(segment.estimate, full_space_error) ? 1 : 0;
  tally.unbounded += segment.bounds.back().holds ? 0 : 1;
  for (std::size_t k = 0; k < segment.errors.size(); ++k) {
    const auto& bound = segment.bounds[k];
    const double error = segment.errors[k], most = bound.error + bound.rounding;
    INFO("at length/2^" << segment.errors.size() - 1 - k << ": error " << error << ", bound " << bound.error << ", rounding "
                        << bound.rounding);
    if (bound.holds) CHECK(error <= bound.error + most_roundings * bound.rounding + reference_rounding);
    if (bound.holds && error > visible) tally.factors.push_back(most / error);
  }
}

void check_segments(std::uint64_t networks, double tolerance) {
  EstimateTally tally;
  for (std::uint64_t seed = 1; seed <= networks; ++seed) {
    RandomMotion motion(seed);
    const auto segment = judge(motion, tolerance);
    if (!segment) continue;
    INFO("network " << seed << ", tolerance " << tolerance << ", " << segment->vectors << " vectors, estimated at " << segment->estimate);
    check_segment(*segment, tolerance, tally);
  }
  CHECK(tally.judged == networks);
  const auto part = [&](std::uint64_t count) { return static_cast<double>(count) / static_cast<double>(networks); };
  CHECK(part(tally.misjudged) <= its_share);
  CHECK(part(tally.far_below) <= share_far_below);
  CHECK(part(tally.unbounded) <= its_share);
  REQUIRE(!tally.factors.empty());
  const auto middle = tally.factors.begin() + static_cast<std::ptrdiff_t>(tally.factors.size() / 2);
  std::nth_element(tally.factors.begin(), middle, tally.factors.end());
  CHECK(*middle <= most_in_median);
}

}  // namespace

TEST_CASE("errors of exact segments of random networks are about their tolerance, and within their bounds", "[unit]") {
  check_segments(300, GENERATE(1e-12, 1e-9, 1e-6));
}

TEST_CASE("errors of exact segments of 10,000 random networks are about their tolerance, and within their bounds", "[unit][long]") {
  check_segments(10000, GENERATE(1e-12, 1e-9, 1e-6));
}
