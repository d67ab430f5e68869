/// The solvers beside those of Siconos (https://nonsmooth.gricad-pages.univ-grenoble-alpes.fr/siconos): its lexicographic Lemke and its enumeration.
#include <LCP_Solvers.h>
#include <LinearComplementarityProblem.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <lcp_cst.h>

#include <catch2/catch.hpp>
#include <memory>

#include "lcp/problem_classes.hpp"
#include "lcp/solve.hpp"

/// What Siconos does not free is not looked at (AddressSanitizer).
extern "C" const char* __lsan_default_suppressions() { return "leak:libsiconos_numerics"; }

using namespace pwlsim;
using namespace pwlsim::test;
using linalg::Matrix;
using linalg::Vector;

namespace {

constexpr double agreement = 1e-8;  ///< of two ways to solve small random problems of order one
constexpr double accepted = 1e-8;   ///< of q, what w and z may violate in what Siconos calls a solution: not of z, which may run away

struct Theirs {
  bool solved = false;
  Vector z;
};

Theirs solve_by_siconos(int solver, Matrix m, Vector q) {
  const auto k = static_cast<int>(q.size());
  Theirs result{false, Vector::Zero(k)};
  Vector w = Vector::Zero(k);
  NumericsMatrix matrix;
  NM_null(&matrix);
  NM_fill(&matrix, NM_DENSE, k, k, m.data());
  LinearComplementarityProblem problem{k, &matrix, q.data()};
  const std::unique_ptr<SolverOptions, decltype(&solver_options_delete)> options(solver_options_create(solver), &solver_options_delete);
  const int info = linearComplementarity_driver(&problem, result.z.data(), w.data(), options.get());
  const Vector exact = m * result.z + q;
  result.solved = info == 0 && exact.cwiseMin(result.z).cwiseAbs().maxCoeff() <= accepted * q.cwiseAbs().maxCoeff();
  return result;
}

}  // namespace

TEST_CASE("what Siconos finds by enumeration or by Lemke's method, the driver finds", "[unit]") {
  const ProblemClass& problems = problem_classes()[static_cast<std::size_t>(GENERATE(range(0, 9)))];
  const int solver = GENERATE(SICONOS_LCP_ENUM, SICONOS_LCP_LEMKE);
  int solved = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    INFO(problems.name << ", seed " << seed << ", solver " << solver);
    Problems random(seed);
    const int k = 2 + static_cast<int>(seed % 7);
    const Matrix m = problems.matrix(random, k);
    const Vector q = problems.right(random, m);
    const Theirs theirs = solve_by_siconos(solver, m, q);
    const lcp::AssessedSolution ours = lcp::solve(m, q);
    if (theirs.solved) ++solved;
    if (theirs.solved && (problems.promised & by_lemke) != 0) REQUIRE(ours.status == lcp::Status::solved);
    // Where bases are singular its enumeration may pass over the solution.
    if (solver == SICONOS_LCP_ENUM && (problems.promised & by_least_index) != 0) CHECK(theirs.solved);
    if (!theirs.solved || ours.status != lcp::Status::solved) continue;
    if ((problems.promised & by_least_index) != 0)
      CHECK((ours.z - theirs.z).norm() <= agreement * (1.0 + theirs.z.norm()));
    else if (lcp::is_monotone(m))  // (M + Mᵀ) z is the same for all solutions (Cottle, Pang, Stone, theorem 3.1.7)
      CHECK(((m + m.transpose()) * (ours.z - theirs.z)).norm() <= agreement * (1.0 + theirs.z.norm()));
  }
  CHECK(solved > 10);
}
