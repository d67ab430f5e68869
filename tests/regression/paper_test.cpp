/// The decks of netlists/paper and the blocks they are made of, against closed forms.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <sstream>

#include "regression/comparison.hpp"
#include "regression/deck_run.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

constexpr double paper_bound = 1e-12;  ///< of values of order one
using std::numbers::phi;
using std::numbers::pi;
const double root5 = std::sqrt(5.0);

std::string paper_text(const std::string& name) {
  std::ifstream file(std::string(PWLSIM_SOURCE_DIR) + "/netlists/paper/" + name + ".net");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

DeckRun paper_deck(const std::string& name) { return run_deck(std::string(PWLSIM_SOURCE_DIR) + "/netlists/paper/" + name + ".net"); }

/// The same deck with another value of a parameter of order 1e-3 or 1e6.
DeckRun with_parameter(const std::string& name, const std::string& from, const std::string& to) {
  std::string text = paper_text(name);
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return run_text(text.replace(at, from.size(), to));
}

using Function = std::function<double(double)>;

void check_certified(const DeckRun& run) {
  INFO(run.messages << run.answer.id << " " << run.answer.message);
  REQUIRE(run.messages.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.answer.certificate.complementarity <= 1e-9);
  CHECK(run.answer.certificate.kcl_kvl <= 1e-9);
  CHECK(run.answer.certificate.energy <= 1e-9);
}

double worst_error(const DeckRun& run, std::size_t signal, const Function& f, double from = 0.0) {
  double worst = 0.0;
  for (const auto& row : run.rows)
    if (row[0] >= from) worst = std::max(worst, std::abs(row[signal + 1] - f(row[0])));
  return worst;
}

void check_signals(const DeckRun& run, const std::vector<Function>& functions) {
  check_certified(run);
  for (std::size_t k = 0; k < functions.size(); ++k) {
    INFO(run.signals[k]);
    CHECK(worst_error(run, k, functions[k]) <= paper_bound);
  }
}

}  // namespace

TEST_CASE("paper: two carts hit the stop, and leave it a quarter turn later", "[regression]") {
  const DeckRun run = paper_deck("carts_hit");
  const auto after = [](double t) { return t - pi / 2.0; };
  check_signals(
      run, {[&](double t) { return t < pi / 2.0 ? 0.0 : (phi * std::sin(after(t) / phi) - std::sin(phi * after(t)) / phi) / root5; },
            [&](double t) {
              return t < pi / 2.0 ? -std::cos(t) : (phi * phi * std::sin(after(t) / phi) + std::sin(phi * after(t)) / (phi * phi)) / root5;
            }});
}

// A stiff spring gives the velocity back: the limit is the free motion from (0, -1, 1, 0), an error of order 1/sqrt(k).
TEST_CASE("paper: a stiff spring in the stop's place converges to a bounce", "[regression]") {
  const auto bounced = [](double t) {
    // Modes x2 = phi x1 of frequency 1/phi and x2 = -x1/phi of frequency phi.
    const double p = 1.0 / (1.0 + phi * phi), q = 1.0 - p;
    return (std::cos(phi * t) - std::cos(t / phi)) / root5 + p * phi * std::sin(t / phi) + q / phi * std::sin(phi * t);
  };
  std::vector<double> errors;
  for (const char* k : {"k=1e4", "k=1e6", "k=1e8"}) {
    const DeckRun run = with_parameter("carts_hit", "k=1e6", k);
    check_certified(run);
    double worst = 0.0;
    for (const auto& row : run.rows)
      if (row[0] <= 0.8) worst = std::max(worst, std::abs(row[6] - bounced(row[0])));
    errors.push_back(worst);
  }
  CHECK(errors[0] / errors[1] == Approx(10.0).epsilon(0.2));
  CHECK(errors[1] / errors[2] == Approx(10.0).epsilon(0.2));
}

TEST_CASE("paper: two events at one instant", "[regression]") {
  const DeckRun run = paper_deck("carts_leave");
  check_signals(run, {[](double t) { return (std::cos(t / phi) - std::cos(phi * t)) / root5; },
                      [](double t) { return (phi * std::cos(t / phi) + std::cos(phi * t) / phi) / root5; }});
}

TEST_CASE("paper: an input pulls the carts away from rest at once", "[regression]") {
  const double a = -(1.0 + 2.0 * phi) / root5, b = a + 2.0;
  check_signals(paper_deck("carts_input"), {[&](double t) { return t + a * std::sin(t / phi) + b * std::sin(phi * t); },
                                            [&](double t) { return 2.0 * t + phi * a * std::sin(t / phi) - b * std::sin(phi * t) / phi; }});
}

TEST_CASE("paper: Coulomb friction stops for good, a steep line creeps", "[regression]") {
  // Half turns around 1, -1, 1: amplitudes 4.5, 2.5, 0.5.
  const auto x = [](double t) {
    if (t < pi) return 1.0 + 4.5 * std::cos(t);
    if (t < 2.0 * pi) return -1.0 + 2.5 * std::cos(t);
    return t < 3.0 * pi ? 1.0 + 0.5 * std::cos(t) : 0.5;
  };
  const DeckRun run = paper_deck("coulomb");
  check_signals(run, {x});
  std::vector<double> errors;
  for (const char* eps : {"eps=1e-2", "eps=1e-3", "eps=1e-4"}) {
    const DeckRun smooth = with_parameter("coulomb", "eps=1e-3", eps);
    check_certified(smooth);
    errors.push_back(worst_error(smooth, 3, x));
  }
  CHECK(errors[0] / errors[1] == Approx(10.0).epsilon(0.2));
  CHECK(errors[1] / errors[2] == Approx(10.0).epsilon(0.2));
}

TEST_CASE("paper: a relay slides, a steep line lies beside it", "[regression]") {
  const double hit = 1.0 - std::sqrt(0.5);
  const auto x = [&](double t) {
    if (t < hit) return 0.25 - t + 0.5 * t * t;
    return t < 1.0 ? 0.0 : 0.5 * (t - 1.0) * (t - 1.0);
  };
  check_signals(paper_deck("relay"), {x});
  std::vector<double> errors;
  for (const char* eps : {"eps=1e-2", "eps=1e-3", "eps=1e-4"}) {
    const DeckRun smooth = with_parameter("relay", "eps=1e-3", eps);
    check_certified(smooth);
    errors.push_back(worst_error(smooth, 2, x));
  }
  CHECK(errors[0] / errors[1] == Approx(10.0).epsilon(0.2));
  CHECK(errors[1] / errors[2] == Approx(10.0).epsilon(0.2));
}

TEST_CASE("paper: the relay's sign decides whether there is one continuation or three", "[regression]") {
  check_signals(paper_deck("relay_right"), {[](double t) { return std::max(1.0 - t, 0.0); }});
  const DeckRun wrong = paper_deck("relay_wrong");
  CHECK(wrong.answer.outcome == engine::Outcome::not_unique);
  CHECK(wrong.answer.message.find("A1") != std::string::npos);
}

TEST_CASE("paper: saturation", "[regression]") {
  check_signals(paper_deck("saturation"), {[](double t) { return t < 1.0 ? 2.0 - t : std::exp(-(t - 1.0)); }});
}

TEST_CASE("11, paper: a relay with dead zone has five modes", "[hard]") {
  check_signals(paper_deck("relay_deadzone"),
                {[](double t) { return std::max(1.0 - t, 0.5); }, [](double t) { return t < 0.5 ? 1.0 : 0.0; },
                 [](double t) { return t - 1.0; }, [](double t) { return t < 0.5 ? -1.0 : (t < 1.5 ? 0.0 : 1.0); }});
  CHECK(paper_deck("relay_deadzone").answer.statistics.modes_visited == 2);  // of these x passes two: beside the dead zone, and in it
}

TEST_CASE("paper: a passive network with diodes", "[regression]") {
  const DeckRun run = paper_deck("passive");
  check_certified(run);
  CHECK(run.answer.certificate.passive);
  // Five independent rows of 80-bit arithmetic, anchors of the design: v(a), i(L1) at 1 to 5 ms.
  const double expected[5][2] = {{-6.4472632148001, -.04596960608386},
                                 {2.2081874159696, .05354719239179},
                                 {.9110380674146, -.04854090271778},
                                 {-2.4705842561313, .02627640014561},
                                 {2.8004033362933, -.00843961704360}};
  for (std::size_t k = 0; k < 5; ++k) {
    CHECK(run.rows[k + 1][1] == Approx(expected[k][0]).margin(1e-12 * 10.0));
    CHECK(run.rows[k + 1][2] == Approx(expected[k][1]).margin(1e-12));
  }
}

TEST_CASE("paper: a Hamiltonian system with two stops", "[regression]") {
  const double meet = 2.0 * pi / 3.0;
  check_signals(paper_deck("stops"), {[](double t) { return std::max(-t, -1.0); }, [](double t) { return t < 1.0 ? -1.0 : 0.0; },
                                      [&](double t) { return t < meet ? 2.0 * std::cos(t) : -std::cos(t - meet); }});
}

// Dynamic programming: beyond x = 1/2 the control is -1/2 and the value function's slope p solves p' = -x backwards from p = x = 1/2.
TEST_CASE("paper: optimal control with a bound", "[regression]") {
  const auto x = [](double t) { return t < 3.0 ? 2.0 - 0.5 * t : 0.5 * std::exp(-(t - 3.0)); };
  const auto p = [&](double t) { return t < 3.0 ? 0.5 + 0.5 * (3.0 - t) + 0.25 * (3.0 - t) * (3.0 - t) : x(t); };
  check_signals(paper_deck("optimal_control"), {x, p, [&](double t) { return t < 3.0 ? p(t) - 0.5 : 0.0; }});
}
