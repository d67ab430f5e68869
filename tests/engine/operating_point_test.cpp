/// Operating points of circuits whose potentials and charges DC leaves open, against enumeration of every face of their solution sets.
#include <Eigen/Dense>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <optional>
#include <random>

#include "support/circuit.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Card {
  char kind;
  int p, n;
  double value;
};

std::string name_of(int node) { return node == 0 ? "0" : "n" + std::to_string(node); }

constexpr double drop = 0.6;

bool is_store(const Card& card) { return card.kind == 'C' || card.kind == 'L'; }

/// Voltages of capacitors and currents of inductors, in the order of the cards.
TestCircuit circuit_of(const std::vector<Card>& cards) {
  TestCircuit c;
  for (const auto& [kind, p, n, value] : cards) {
    const std::string a = name_of(p), b = name_of(n);
    if (kind == 'V') c.v(a, b, model::Dc{value});
    if (kind == 'R') c.r(a, b, value);
    if (kind == 'D') c.d(a, b, drop);
    if (kind == 'L') c.save_i_l(c.l(a, b, value));
    if (kind != 'C') continue;
    c.c(a, b, value);
    c.save_v(a, b);
  }
  return c;
}

struct OperatingPoint {
  bool prepared = false, exists = false;
  std::vector<double> values;
};

OperatingPoint point_of(const TestCircuit& c) {
  OperatingPoint result;
  Diagnostics diagnostics;
  const auto model = engine::prepare(c.network(), diagnostics);
  if (!model) return result;
  result.prepared = true;
  const engine::OperatingPoint point = engine::operating_point(*model);
  result.exists = point.answer.outcome == engine::Outcome::completed;
  result.values = point.values;
  return result;
}

/// Kirchhoff's equations at DC, unknowns: node voltages, then a current for each V, L and D. Each diode is one of: v = drop, i free; i = 0,
/// v free; both. The point of least energy lies in the inside of one of these faces, where no inequality acts.
class Enumeration {
 public:
  explicit Enumeration(const std::vector<Card>& cards) : cards_(cards) {
    for (const Card& card : cards) {
      nodes_ = std::max({nodes_, card.p, card.n});
      if (card.kind == 'D') ++diodes_;
    }
    unknowns_ = nodes_;
    for (const Card& card : cards) current_.push_back(card.kind == 'V' || card.kind == 'L' || card.kind == 'D' ? unknowns_++ : -1);
  }

  /// The stores' values.
  [[nodiscard]] std::optional<VectorXd> least() const {
    std::optional<VectorXd> best;
    double least = 0.0;
    int faces = 1;
    for (int i = 0; i < diodes_; ++i) faces *= 3;
    for (int face = 0; face < faces; ++face) {
      const auto z = least_on(face);
      if (!z) continue;
      const double energy = (weighted_stores() * *z).squaredNorm();
      if (best && energy >= least) continue;
      least = energy;
      best = stores() * *z;
    }
    return best;
  }

 private:
  [[nodiscard]] VectorXd voltage(const Card& card) const {
    VectorXd row = VectorXd::Zero(unknowns_);
    if (card.p > 0) row[card.p - 1] += 1.0;
    if (card.n > 0) row[card.n - 1] -= 1.0;
    return row;
  }

  [[nodiscard]] VectorXd unit(int unknown) const {
    VectorXd row = VectorXd::Zero(unknowns_);
    if (unknown >= 0) row[unknown] = 1.0;
    return row;
  }

  [[nodiscard]] MatrixXd stores() const {
    MatrixXd rows(0, unknowns_);
    for (std::size_t i = 0; i < cards_.size(); ++i) {
      if (!is_store(cards_[i])) continue;
      rows.conservativeResize(rows.rows() + 1, Eigen::NoChange);
      const VectorXd row = cards_[i].kind == 'C' ? voltage(cards_[i]) : unit(current_[i]);
      rows.bottomRows(1) = row.transpose();
    }
    return rows;
  }

  [[nodiscard]] MatrixXd weighted_stores() const {
    MatrixXd rows = stores();
    Eigen::Index next = 0;
    for (const Card& card : cards_)
      if (is_store(card)) rows.row(next++) *= std::sqrt(card.value);
    return rows;
  }

  [[nodiscard]] std::optional<VectorXd> least_on(int face) const {
    MatrixXd m = MatrixXd::Zero(nodes_, unknowns_);
    VectorXd right = VectorXd::Zero(nodes_);
    const auto add = [&](const VectorXd& row, double value) {
      m.conservativeResize(m.rows() + 1, Eigen::NoChange);
      m.bottomRows(1) = row.transpose();
      right.conservativeResize(right.size() + 1);
      right[right.size() - 1] = value;
    };
    for (std::size_t i = 0; i < cards_.size(); ++i) {
      const Card& card = cards_[i];
      const VectorXd v = voltage(card);
      const VectorXd current = card.kind == 'R' ? VectorXd(v / card.value) : unit(current_[i]);
      if (card.p > 0) m.row(card.p - 1) += current.transpose();
      if (card.n > 0) m.row(card.n - 1) -= current.transpose();
      if (card.kind == 'V') add(v, card.value);
      if (card.kind == 'L') add(v, 0.0);
      if (card.kind != 'D') continue;
      const int state = face % 3;
      face /= 3;
      if (state != 0) add(v, drop);
      if (state != 1) add(current, 0.0);
    }
    const Eigen::CompleteOrthogonalDecomposition<MatrixXd> of_equations(m);
    VectorXd z = of_equations.solve(right);
    if ((m * z - right).norm() > 1e-9 * (1.0 + right.norm())) return std::nullopt;
    const MatrixXd kernel = Eigen::FullPivLU<MatrixXd>(m).setThreshold(1e-10).kernel();
    const MatrixXd weights = weighted_stores();
    if (of_equations.rank() < unknowns_ && weights.rows() > 0)
      z -= kernel * (weights * kernel).completeOrthogonalDecomposition().solve(weights * z);
    for (std::size_t i = 0; i < cards_.size(); ++i)
      if (cards_[i].kind == 'D' && (z[current_[i]] < -1e-8 || voltage(cards_[i]).dot(z) > drop + 1e-8)) return std::nullopt;
    return z;
  }

  const std::vector<Card>& cards_;
  std::vector<int> current_;
  int nodes_ = 0, unknowns_ = 0, diodes_ = 0;
};

/// A source, a tree over all nodes and some cards more.
std::vector<Card> random_cards(std::mt19937& random) {
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  constexpr double values[] = {1.0, 1.5, 2.2, 3.3, 4.7, 6.8};
  int diodes = 0;
  const auto card = [&](int p, int n) {
    char kind = "DDDCCCRRL"[below(9)];
    if (kind == 'D' && ++diodes > 5) kind = 'C';
    const double value = values[below(6)] * (kind == 'R' ? std::pow(10.0, below(3)) : std::pow(10.0, below(3) - 6));
    return below(2) == 0 ? Card{kind, p, n, value} : Card{kind, n, p, value};
  };
  const int nodes = 3 + below(3);
  std::vector<Card> cards{{'V', 1, 0, below(2) == 0 ? 10.0 : -5.0}};
  for (int node = 2; node <= nodes; ++node) cards.push_back(card(node, below(node)));
  for (int more = 1 + below(4); more > 0; --more) {
    const int p = below(nodes + 1), n = below(nodes + 1);
    if (p != n) cards.push_back(card(p, n));
  }
  return cards;
}

std::string text_of(const std::vector<Card>& cards) {
  std::string text;
  for (const Card& c : cards)
    text += std::string(1, c.kind) + " " + name_of(c.p) + " " + name_of(c.n) + " " + std::to_string(c.value) + "\n";
  return text;
}

}  // namespace

// No current flows into a capacitor at DC, so that v(b) is the source's; D1 holds v(c) at or above 0, and nearest to v(b) it stores least.
TEST_CASE("a capacitor behind a blocked diode has an operating point at every value", "[unit]") {
  constexpr double e24[] = {1.0, 1.1, 1.2, 1.3, 1.5, 1.6, 1.8, 2.0, 2.2, 2.4, 2.7, 3.0,
                            3.3, 3.6, 3.9, 4.3, 4.7, 5.1, 5.6, 6.2, 6.8, 7.5, 8.2, 9.1};
  std::mt19937 random(22);
  for (int run = 0; run < 300; ++run) {
    const double r = e24[random() % 24] * std::pow(10.0, static_cast<double>(random() % 7));
    const double c = e24[random() % 24] * std::pow(10.0, static_cast<double>(random() % 9) - 12.0);
    const double source = run % 2 == 0 ? -10.0 : 10.0;
    TestCircuit circuit;
    circuit.v("a", "0", model::Dc{source});
    circuit.r("a", "b", run == 0 ? 565.354 : r);
    circuit.c("b", "c", run == 0 ? 9.5e-9 : c);
    circuit.d("0", "c");
    circuit.save_v("b");
    circuit.save_v("c");
    CAPTURE(r, c, source);
    const OperatingPoint point = point_of(circuit);
    REQUIRE(point.exists);
    CHECK(point.values[0] == Approx(source).epsilon(1e-12));
    CHECK(point.values[1] == Approx(std::max(source, 0.0)).margin(1e-10));
  }
}

TEST_CASE("operating points exist where enumeration finds one, and are those of least energy", "[unit]") {
  std::mt19937 random(7);
  int found = 0, none = 0;
  for (int run = 0; run < 250; ++run) {
    std::vector<Card> cards = random_cards(random);
    CAPTURE(run, text_of(cards));
    if (std::none_of(cards.begin(), cards.end(), is_store)) continue;
    const OperatingPoint point = point_of(circuit_of(cards));
    if (!point.prepared) continue;  // loops of sources and inductors, cutsets
    const auto least = Enumeration(cards).least();
    REQUIRE(point.exists == least.has_value());
    ++(point.exists ? found : none);
    if (!least) continue;
    const double scale = std::max(1.0, least->cwiseAbs().maxCoeff());
    for (Eigen::Index i = 0; i < least->size(); ++i)
      CHECK(point.values[static_cast<std::size_t>(i)] == Approx((*least)[i]).margin(1e-6 * scale));
  }
  CHECK(found > 100);
  CHECK(none > 5);
}

TEST_CASE("an operating point does not depend on the order of the cards", "[unit]") {
  std::mt19937 random(11);
  for (int run = 0; run < 60; ++run) {
    const std::vector<Card> cards = random_cards(random);
    CAPTURE(run, text_of(cards));
    std::vector<std::size_t> order(cards.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    const OperatingPoint first = point_of(circuit_of(cards));
    std::vector<std::size_t> stores;
    for (std::size_t i = 0; i < cards.size(); ++i)
      if (is_store(cards[i])) stores.push_back(i);
    for (int permutation = 0; permutation < 10; ++permutation) {
      std::shuffle(order.begin(), order.end(), random);
      std::vector<Card> shuffled;
      std::vector<std::size_t> place;  // of each store saved, among the stores of `cards`
      for (const std::size_t i : order) {
        shuffled.push_back(cards[i]);
        if (is_store(cards[i])) place.push_back(static_cast<std::size_t>(std::find(stores.begin(), stores.end(), i) - stores.begin()));
      }
      const OperatingPoint other = point_of(circuit_of(shuffled));
      REQUIRE(other.exists == first.exists);
      if (!first.exists) continue;
      double scale = 1.0;
      for (const double value : first.values) scale = std::max(scale, std::abs(value));
      for (std::size_t k = 0; k < place.size(); ++k) CHECK(other.values[k] == Approx(first.values[place[k]]).margin(1e-8 * scale));
    }
  }
}
