/// What certifies that a system has one solution.
#include "model/certificate.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "support/circuit.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using model::has_positive_principal_minors;
using model::Matrix;

namespace {

/// The definition: every one of the 2^k − 1 determinants.
bool all_minors_positive(const Matrix& m) {
  for (unsigned set = 1; set < (1U << m.rows()); ++set) {
    std::vector<Eigen::Index> members;
    for (Eigen::Index i = 0; i < m.rows(); ++i)
      if ((set >> i) & 1U) members.push_back(i);
    if (!(Matrix(m(members, members)).determinant() > 0.0)) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("P-matrices: positive definite, cyclic, and neighbours that are not", "[unit]") {
  Matrix cyclic(3, 3), relay(2, 2), indefinite(2, 2);
  cyclic << 1, 0, 2, 2, 1, 0, 0, 2, 1;  // Ben Gharbia and Gilbert: minors 1, 1, 1, 1, 1, 1, 9
  relay << 0, 1, -1, 0;                 // minors 0, 0, 1
  indefinite << 1, 2, 2, 1;             // minors 1, 1, −3
  CHECK(has_positive_principal_minors(cyclic));
  CHECK_FALSE(has_positive_principal_minors(relay));
  CHECK_FALSE(has_positive_principal_minors(indefinite));
  CHECK(has_positive_principal_minors(Matrix(0, 0)));
}

TEST_CASE("principal minors agree with their definition", "[property]") {
  std::mt19937 random(20);
  std::normal_distribution<double> normal;
  int positive = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const int k = 1 + trial % 6;
    Matrix m = Matrix::NullaryExpr(k, k, [&] { return normal(random); });
    m.diagonal().array() += 1.0;
    const Matrix scaled =
        Eigen::VectorXd::LinSpaced(k, 0, k - 1).array().unaryExpr([](double e) { return std::pow(10.0, 3.0 * e); }).matrix().asDiagonal() *
        m;
    INFO("trial " << trial);
    CHECK(has_positive_principal_minors(m) == all_minors_positive(m));
    CHECK(has_positive_principal_minors(scaled) == all_minors_positive(m));
    positive += all_minors_positive(m) ? 1 : 0;
  }
  CHECK(positive > 40);
}

TEST_CASE("a voltage branch that follows its own current is a resistor, passive where it is positive", "[unit]") {
  const double resistance = GENERATE(5.0, -5.0);
  TestCircuit c;
  c.c("a", "0", 1.0);
  const int branch = c.e("a", "0", "a", "0", 0.0);
  c.network().branches[static_cast<std::size_t>(branch)].voltage = {{model::Term::Kind::branch_current, branch, resistance}};
  CHECK(model::has_passive_parts_only(c.network()) == (resistance > 0.0));
}
