/// Mode selection three ways on random systems: the cascade of linear complementarity problems (LDCP), the selector as runs use it, and the enumeration of
/// all modes in exact integers, which decides.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <iostream>
#include <set>
#include <utility>

#include "model/cascade.hpp"
#include "model/handmade_systems.hpp"
#include "model/markov.hpp"
#include "model/random_systems.hpp"
#include "model/selection.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using model::Matrix;
using model::SelectionOutcome;
using model::Vector;
using model::Verdict;

namespace {

constexpr double agreement = 1e-9;  ///< of states after a jump, of numbers of order one
constexpr int most_stages = 6;      ///< jumps at one instant that are followed exactly
constexpr std::size_t most_ends = 50;

using Sets = std::pair<unsigned, unsigned>;  ///< active, inactive

unsigned bits_of(const model::IndexSet& set, int k) {
  unsigned bits = 0;
  for (int i = 0; i < k; ++i)
    if (set.contains(i)) bits |= 1U << static_cast<unsigned>(i);
  return bits;
}

std::set<Sets> sets_of(const model::CascadeOutcome& outcome, int k) {
  std::set<Sets> sets;
  for (const auto& c : outcome.continuations) sets.insert({bits_of(c.active, k), bits_of(c.inactive, k)});
  return sets;
}

std::set<Sets> sets_of(const ExactOutcome& outcome, bool with_jumps) {
  std::set<Sets> sets;
  for (const auto& s : outcome.solutions)
    if (with_jumps || !s.jumps) sets.insert({s.active, s.inactive});
  return sets;
}

std::vector<Integer> integers(const Vector& x) {
  std::vector<Integer> result;
  for (const double value : x) result.emplace_back(static_cast<long long>(value));
  return result;
}

double size_of(const std::vector<Integer>& x) {
  double sum = 0.0;
  for (const Integer& value : x) sum += value.convert_to<double>() * value.convert_to<double>();
  return std::sqrt(sum);
}

/// Where the instant can end: smooth continuations after all sequences of jumps.
struct Ends {
  bool exact = true;      ///< not too many stages
  bool regular = true;    ///< every mode at every stage: then there are no others
  bool branches = false;  ///< some stage has several solutions
  bool dead = false;      ///< some sequence of jumps ends without solution
  std::vector<ExactSolution> smooth;
};

void follow(const IntegerSystem& system, const std::vector<Integer>& x, double scale, int stage, Ends& ends) {
  const ExactOutcome outcome = solve_exactly(system, x, scale);
  ends.exact &= stage < most_stages && ends.smooth.size() < most_ends;
  ends.regular &= outcome.all_regular;
  if (!ends.exact) return;
  ends.branches |= outcome.solutions.size() > 1;
  ends.dead |= outcome.solutions.empty();
  for (const ExactSolution& s : outcome.solutions) {
    if (!s.jumps)
      ends.smooth.push_back(s);
    else
      follow(system, s.after, size_of(s.after) > 0.0 ? s.state_after.norm() / size_of(s.after) : 1.0, stage + 1, ends);
  }
}

struct Tally {
  int systems = 0, hypothesis = 0, uniform = 0;
  std::array<int, 4> degree{};
  std::array<int, 4> of_cascade{};                       ///< by Verdict
  std::array<int, 3> of_enumeration{};                   ///< none, one, several
  int irregular = 0, compared = 0, states_compared = 0;  ///< cascade with enumeration
  int ends_unique = 0, ends_several = 0, ends_none = 0, ends_inexact = 0;
  int selected_found = 0, selected_several = 0, selected_none = 0;
  int selected_beyond = 0;  ///< a solution in a mode whose u is not unique, which the enumeration leaves out
  int certified = 0;        ///< unique for every x by the rational problem's matrix alone
  std::vector<std::uint64_t> selected_wrong;

  void print() const {
    std::cout << systems << " systems: " << uniform << " of uniform relative degree (0: " << degree[0] << ", 1: " << degree[1]
              << ", 2: " << degree[2] << ", 3: " << degree[3] << "), " << hypothesis
              << " with positive leading minors\n  enumeration: none " << of_enumeration[0] << ", one " << of_enumeration[1] << ", several "
              << of_enumeration[2] << "; a singular mode in " << irregular << "\n  cascade: none " << of_cascade[0] << ", unique "
              << of_cascade[1] << ", several " << of_cascade[2] << ", undecided " << of_cascade[3] << "; compared " << compared
              << "\n  after all jumps: none " << ends_none << ", one " << ends_unique << ", several " << ends_several << ", not followed "
              << ends_inexact << "\n  selector: found " << selected_found << ", several " << selected_several << ", none " << selected_none
              << ", of these in a singular mode " << selected_beyond << ", not confirmed " << selected_wrong.size()
              << "\n  unique for every x: " << certified << "\n";
  }
};

/// The cascade against the enumeration: the same sets, and the same states after jumps.
void compare_cascade(const RandomSystem& random, const ExactOutcome& exact, Tally& tally) {
  const auto& [a, b, c, d] = random.system;
  const int k = random.system.k();
  const model::Cascade cascade(a, b, c, d);
  const model::CascadeOutcome all = cascade.impulsive(random.x, 0.0);
  const model::CascadeOutcome smooth = cascade.smooth(random.x, 0.0);
  ++tally.of_cascade[static_cast<std::size_t>(all.verdict)];
  if (cascade.one_solution()) CHECK(all.verdict == Verdict::unique);
  if (cascade.one_solution() || model::has_positive_leading_minors(model::markov_parameters(a, b, c, d))) {
    ++tally.hypothesis;
    CHECK(exact.all_regular);
    CHECK(exact.solutions.size() == 1);
  }
  if (!exact.all_regular || all.verdict == Verdict::undecided || smooth.verdict == Verdict::undecided) return;
  ++tally.compared;
  CHECK(sets_of(all, k) == sets_of(exact, true));
  CHECK(sets_of(smooth, k) == sets_of(exact, false));
  CHECK(all.continuations.size() == exact.solutions.size());
  for (const auto& found : all.continuations)
    for (const auto& expected : exact.solutions) {
      if (bits_of(found.active, k) != expected.active || bits_of(found.inactive, k) != expected.inactive) continue;
      CHECK(found.jumps == expected.jumps);
      CHECK((found.state_after - expected.state_after).norm() <= agreement * (1.0 + expected.state_after.norm()));
      ++tally.states_compared;
    }
}

/// Whether the answer of the selector is one of the ends: the state, and a mode between the active set and the active with the indeterminate.
bool confirmed(const model::Selected& selected, const Vector& x, const Ends& ends, int k) {
  switch (selected.outcome) {
    case SelectionOutcome::found:
    case SelectionOutcome::several: {
      const unsigned mode = bits_of(selected.mode->active, k);
      const bool is_end = std::any_of(ends.smooth.begin(), ends.smooth.end(), [&](const ExactSolution& s) {
        return (mode & s.active) == s.active && (mode & s.inactive) == 0 &&
               (x - s.state_after).norm() <= agreement * (1.0 + s.state_after.norm());
      });
      return is_end && (ends.branches || selected.outcome == SelectionOutcome::found);
    }
    case SelectionOutcome::none:
      return ends.dead;
    case SelectionOutcome::too_many_jumps:
      return false;
  }
  return false;
}

/// Without jump: as many continuations as there are.
bool counted_right(const model::Selected& selected, const ExactOutcome& exact) {
  if (selected.jumps > 0 || selected.outcome == SelectionOutcome::none || !exact.all_regular) return true;
  const auto smooth = std::count_if(exact.solutions.begin(), exact.solutions.end(), [](const ExactSolution& s) { return !s.jumps; });
  const std::size_t counted = selected.outcome == SelectionOutcome::several ? selected.details->continuations.size() : 1;
  return counted == static_cast<std::size_t>(smooth);
}

/// Whatever ports that are one another's twins share: one state, and one motion from it.
bool go_on_alike(const Ends& ends, model::Selector& selector, int k) {
  const auto mode_of = [&](const ExactSolution& s) -> const model::Mode& {
    model::IndexSet set(k);
    for (int i = 0; i < k; ++i) set.set(i, ((s.active >> static_cast<unsigned>(i)) & 1U) != 0);
    return selector.modes().mode(set);
  };
  return std::all_of(ends.smooth.begin(), ends.smooth.end(), [&](const ExactSolution& s) {
    const Vector& first = ends.smooth[0].state_after;
    return (s.state_after - first).norm() <= agreement * (1.0 + first.norm()) &&
           selector.continues_alike(mode_of(ends.smooth[0]), mode_of(s), first.data());
  });
}

void compare_selector(std::uint64_t seed, const RandomSystem& random, const ExactOutcome& exact, const Ends& ends, Tally& tally) {
  const auto& [a, b, c, d] = random.system;
  const int k = random.system.k();
  const model::System system = handmade(a, b, c, d);
  model::Selector selector(system, model::Several::stay);
  Vector x = random.x;
  const model::Selected selected = selector.select(x.data(), model::IndexSet(k), -1);
  if (selected.outcome == SelectionOutcome::found) ++tally.selected_found;
  if (selected.outcome == SelectionOutcome::several) ++tally.selected_several;
  if (selected.outcome == SelectionOutcome::none) ++tally.selected_none;
  CHECK(counted_right(selected, exact));
  if (model::RationalProblem(system).is_uniquely_solvable(model::IndexSet(k))) {
    ++tally.certified;
    if (exact.all_regular) CHECK(exact.solutions.size() == 1);
    CHECK(go_on_alike(ends, selector, k));
  }
  if (confirmed(selected, x, ends, k)) return;
  const bool has_mode = selected.outcome == SelectionOutcome::found || selected.outcome == SelectionOutcome::several;
  if (has_mode && !ends.regular)
    ++tally.selected_beyond;
  else
    tally.selected_wrong.push_back(seed);
}

Tally examine(std::uint64_t first, int count) {
  Tally tally;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("seed " << seed);
    const RandomSystem random = SystemMaker(seed).make();
    ++tally.systems;
    const auto& degrees = random.degrees;
    if (!degrees.empty() && std::all_of(degrees.begin(), degrees.end(), [&](int r) { return r == degrees[0]; })) {
      ++tally.uniform;
      ++tally.degree[static_cast<std::size_t>(degrees[0])];
    }
    const ExactOutcome exact = solve_exactly(random.system, integers(random.x));
    ++tally.of_enumeration[std::min<std::size_t>(exact.solutions.size(), 2)];
    if (!exact.all_regular) ++tally.irregular;
    compare_cascade(random, exact, tally);
    Ends ends;
    follow(random.system, integers(random.x), 1.0, 0, ends);
    if (!ends.exact) {
      ++tally.ends_inexact;
      continue;
    }
    ++(ends.smooth.empty() ? tally.ends_none : ends.smooth.size() == 1 ? tally.ends_unique : tally.ends_several);
    compare_selector(seed, random, exact, ends, tally);
  }
  tally.print();
  return tally;
}

}  // namespace

TEST_CASE("cascade, selector and enumeration of modes agree on 1,000 random systems", "[property]") {
  const Tally tally = examine(1, 1000);
  CHECK(tally.hypothesis > 300);
  CHECK(tally.compared > 500);
  CHECK(tally.certified > 200);
  CAPTURE(tally.selected_wrong);
  CHECK(tally.selected_wrong.empty());
}

TEST_CASE("cascade, selector and enumeration of modes agree on 10,000 random systems", "[long]") {
  const Tally tally = examine(100'001, 10'000);
  CAPTURE(tally.selected_wrong);
  CHECK(tally.selected_wrong.empty());
}
