/// The estimated error of exact segments beside the true one, on random passive networks.
#include <algorithm>
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

using Matrix = linalg::Matrix;
using Vector = linalg::Vector;
__extension__ using Quad = __float128;

/// A square matrix, column after column.
template <class Real>
struct Square {
  int size;
  std::vector<Real> entries;

  explicit Square(const Matrix& a, Real factor) : size(static_cast<int>(a.rows())) {
    for (Eigen::Index j = 0; j < a.cols(); ++j)
      for (Eigen::Index i = 0; i < a.rows(); ++i) entries.push_back(static_cast<Real>(a(i, j)) * factor);
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
Square<Real> exponential(const Matrix& a) {
  constexpr int terms = 18;  // 4^−18/18! < 3e-27
  const int halved = std::max(0, static_cast<int>(std::ceil(std::log2(a.cwiseAbs().rowwise().sum().maxCoeff()))) + 2);
  const Square<Real> small(a, static_cast<Real>(std::ldexp(1.0, -halved))), one(Matrix::Identity(a.rows(), a.cols()), Real(1));
  Square<Real> sum = one;
  for (int k = terms; k > 0; --k) {
    sum = small.times(sum);
    for (std::size_t i = 0; i < sum.entries.size(); ++i) sum.entries[i] = sum.entries[i] / static_cast<Real>(k) + one.entries[i];
  }
  for (int k = 0; k < halved; ++k) sum = sum.times(sum);
  return sum;
}

/// e^{A τ} x at τ = length·2^−halvings, doubled until length.
template <class Real>
std::vector<Vector> motion_by(const Matrix& a, const Vector& start, double length, int halvings) {
  Square<Real> flow = exponential<Real>(a * std::ldexp(length, -halvings));
  std::vector<Real> x(start.begin(), start.end()), y(x.size());
  std::vector<Vector> points;
  for (int k = halvings; k >= 0; --k) {
    flow.multiply(x.data(), y.data());
    Vector& point = points.emplace_back(start.size());
    std::transform(y.begin(), y.end(), point.begin(), [](Real value) { return static_cast<double>(value); });
    if (k > 0) flow = flow.times(flow);
  }
  return points;
}

/// The same to 1e-15 of what it moves.
std::vector<Vector> true_motion(const Matrix& a, const Vector& start, double length, int halvings) {
  constexpr double largest = 1e4;
  const double size = length * a.cwiseAbs().rowwise().sum().maxCoeff();
  return size < largest ? motion_by<long double>(a, start, length, halvings) : motion_by<Quad>(a, start, length, halvings);
}

/// Every node has a capacitor to ground; resistors, inductors and a source of current or two between nodes. Its motion is  x' = A x,  x the voltages and currents times
/// √(C R₀) and √(L R₀), as the norm of the stored energy has it, and then a constant and the sine and cosine of the source.
struct RandomMotion {
  explicit RandomMotion(std::uint64_t seed) {
    Random random(seed);
    const auto spread = [&](double low, double high) { return low * std::pow(high / low, random.unit()); };
    const auto node = [](int i) { return i < 0 ? std::string("0") : "n" + std::to_string(i); };
    const int nodes = random.whole(2, 14), coils = random.whole(0, nodes - 1);
    const double decades = random.between(0.5, 6.0), wide = std::pow(10.0, 0.5 * decades);
    length = 1e-6 * spread(1e-2, 1e2);
    const double frequency = spread(1e-2, 10.0) / length, omega = 2.0 * std::numbers::pi * frequency;
    const int size = nodes + coils + 3;
    a = Matrix::Zero(size, size);
    weight.resize(static_cast<std::size_t>(nodes + coils));
    for (int i = 0; i < nodes; ++i) {
      const double farads = 1e-9 * spread(1.0 / wide, wide);
      circuit.c(node(i), "0", farads);
      weight[static_cast<std::size_t>(i)] = std::sqrt(farads);
    }
    const auto voltage = [&](int row, int of, double factor) {  // what a voltage adds to a rate; both still without weights
      if (of >= 0) a(row, of) += factor;
    };
    const auto resistor = [&](int p, int n, double ohms) {
      circuit.r(node(p), node(n), ohms);
      for (const auto& [at, sign] : {std::pair{p, -1.0}, {n, 1.0}}) {
        if (at < 0) continue;
        voltage(at, p, sign / ohms);
        voltage(at, n, -sign / ohms);
      }
    };
    const auto pair = [&] {
      const int p = random.whole(0, nodes - 1);
      const int n = (p + random.whole(1, nodes)) % (nodes + 1) - 1;  // −1: ground
      return std::pair{p, n == p ? -1 : n};
    };
    for (int i = 0; i < nodes; ++i)
      if (random.chance(0.8)) resistor(i, i - 1, 1e3 * spread(1.0 / wide, wide));
    for (int i = 0; i < nodes; ++i) {
      const auto [p, n] = pair();
      resistor(p, n, 1e3 * spread(1.0 / wide, wide));
    }
    for (int k = 0; k < coils; ++k) {
      const auto [p, n] = pair();
      const double henries = 1e-3 * spread(1.0 / wide, wide);
      circuit.l(node(p), node(n), henries);
      const int row = nodes + k;
      weight[static_cast<std::size_t>(row)] = std::sqrt(henries);
      voltage(row, p, 1.0);
      voltage(row, n, -1.0);
      for (const auto& [at, sign] : {std::pair{p, -1.0}, {n, 1.0}})
        if (at >= 0) a(at, row) += sign;
    }
    const int one = nodes + coils;
    if (random.chance(0.7)) {
      const int at = random.whole(0, nodes - 1);
      const double amperes = 1e-3 * random.between(-1.0, 1.0);
      circuit.i("0", node(at), model::Dc{amperes});
      a(at, one) += amperes;
    }
    if (random.chance(0.7)) {
      const int at = random.whole(0, nodes - 1);
      const double amperes = 1e-3 * random.between(-1.0, 1.0);
      circuit.i("0", node(at), sine(amperes, frequency));
      a(at, one + 1) += amperes;
    }
    a(one + 1, one + 2) = omega;
    a(one + 2, one + 1) = -omega;
    for (int i = 0; i < one; ++i) {  // C v' = …, so that √C v has …/√C
      a.row(i) /= weight[static_cast<std::size_t>(i)];
      a.col(i) /= weight[static_cast<std::size_t>(i)];
    }
    start = Vector::Zero(size);
    const bool rests = random.chance(0.2);
    for (int i = 0; i < one && !rests; ++i)
      start[i] = random.chance(0.3) ? 0.0 : random.between(-1.0, 1.0) * (i < nodes ? 1.0 : 1e-3) * weight[static_cast<std::size_t>(i)];
    start[one] = start[one + 2] = 1.0;
  }

  TestCircuit circuit;
  Matrix a;
  Vector start;
  std::vector<double> weight;  ///< of voltages and currents
  double length = 0.0;
};

struct Judged {
  double estimate = 0.0, error = 0.0;  ///< of the largest √energy
  int vectors = 0;
};

/// The first segment of that motion, nothing if it has none.
std::optional<Judged> judge(RandomMotion& motion, double tolerance) {
  const Descriptor descriptor(motion.circuit.network());
  Factors factors(motion.circuit.network(), descriptor);
  const Sources sources(motion.circuit.network());
  const std::vector<WatchedControl> none;
  ExactSegment segment(descriptor, sources, none, tolerance, 64.0 * motion.length);
  segment.note_least_voltage(1e-3);
  const double r0 = descriptor.r0();
  std::vector<double> z(static_cast<std::size_t>(descriptor.size()), 0.0);
  const auto& states = descriptor.states();
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double value = motion.start[static_cast<Eigen::Index>(i)] / motion.weight[i];
    z[static_cast<std::size_t>(states[i].is_current || states[i].plus >= 0 ? states[i].plus : states[i].minus)] =
        states[i].is_current ? value * r0 : value;
  }
  const Position on;
  if (segment.open(factors, {0.0, on, z, {}, motion.length}) != ExactSegment::Opened::yes) return {};
  constexpr int halvings = 8;
  const std::vector<Vector> truth = true_motion(motion.a, motion.start, segment.length(), halvings);
  Judged judged{segment.relative_error(), 0.0, static_cast<int>(segment.counts().vectors)};
  double largest = segment.size();
  for (int k = 0; k <= halvings; ++k) {
    segment.unknowns(segment.at(std::ldexp(segment.length(), k - halvings)), z);
    double square = 0.0;
    for (std::size_t i = 0; i < states.size(); ++i) {
      const double value = states[i].value(z.data()) * (states[i].is_current ? 1.0 / r0 : 1.0);
      square += std::pow(motion.weight[i] * value - truth[static_cast<std::size_t>(k)][static_cast<Eigen::Index>(i)], 2);
    }
    judged.error = std::max(judged.error, std::sqrt(square * r0));
    largest = std::max(largest, std::sqrt(r0) * truth[static_cast<std::size_t>(k)].head(static_cast<Eigen::Index>(states.size())).norm());
  }
  judged.estimate *= segment.size() / largest;
  judged.error /= largest;
  return judged;
}

constexpr double most_tolerances = 10.0;  ///< that an error may be, or estimates where the vectors reach no more: an estimate is no bound
constexpr double rounding = 1e-12;        ///< of the largest √energy: a full space is estimated to have no error
constexpr double largest_factor = 10.0, its_share = 0.005;  ///< so many errors may be more than that times what they are estimated at

void check_estimates(std::uint64_t networks, double tolerance) {
  std::uint64_t judged = 0, far_below = 0;
  for (std::uint64_t seed = 1; seed <= networks; ++seed) {
    RandomMotion motion(seed);
    const auto segment = judge(motion, tolerance);
    if (!segment) continue;
    ++judged;
    INFO("network " << seed << ", tolerance " << tolerance << ", " << segment->vectors << " vectors, estimated at " << segment->estimate);
    CHECK(segment->error <= most_tolerances * std::max(tolerance, segment->estimate));
    far_below += segment->error > largest_factor * std::max(segment->estimate, rounding) ? 1 : 0;
  }
  CHECK(judged == networks);
  CHECK(static_cast<double>(far_below) <= its_share * static_cast<double>(networks));
}

}  // namespace

TEST_CASE("errors of exact segments of random networks are about their tolerance", "[unit]") {
  check_estimates(300, GENERATE(1e-12, 1e-9, 1e-6));
}

TEST_CASE("errors of exact segments of 10,000 random networks are about their tolerance", "[unit][long]") {
  check_estimates(10000, GENERATE(1e-12, 1e-9, 1e-6));
}
