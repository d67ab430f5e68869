#include "engine/exact/static_solution.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "engine/exact/static_mode.hpp"
#include "engine/exact/static_ports.hpp"
#include "engine/exact/tolerances.hpp"
#include "model/valves.hpp"

namespace pwlsim::engine {

namespace {

using linalg::Vector;
using linalg::Wide;
using linalg::WideVector;

/// How weakly states are held, in units of the slowest rate. Too strongly, and what leaks slowly counts as blocked; too weakly, and rounding
/// decides what the hold should: each end of the ladder serves circuits that the other does not.
constexpr double ladder[] = {1e-8, 1e-6, 1e-10, 1e-4, 1e-12, 1e-2, 1e-14};
/// So often ports of a wrong sign change sides, where nothing proposed is a solution: at first never, then what the hold hides (a diode's Roff across milliohms) shows in the mode itself.
constexpr int rounds_of_sides[] = {0, 4};

class StaticProblem {
 public:
  StaticProblem(const model::System& system, const Vector& zeta, const std::vector<char>& switch_active)
      : system_(system),
        zeta_(zeta),
        switch_active_(switch_active),
        blocked_(model::blocked_ports(system, with_switches(system, switch_active))),
        ports_(system, zeta) {}

  struct Found {
    WideVector xi, u;
    double distance = 0.0;
    bool kernel = false;      ///< its mode leaves ξ open
    bool degenerate = false;  ///< of some diode neither u nor y is positive
    std::vector<int> active;
    std::vector<int> wrong;  ///< diodes of which u or y is negative
  };

  /// The first that no other can be nearer to x₀ than, else the nearest found.
  [[nodiscard]] std::optional<Found> nearest(const Vector& x0) const {
    std::optional<Found> best;
    for (const int rounds : rounds_of_sides) {
      if (best) break;
      for (const double share : ladder) {
        const StaticPorts::Proposal proposal = ports_.propose(share * ports_.slowest_rate(), x0, switch_active_);
        for (const auto& active : proposal.active) {
          auto found = solution_from(active, x0, rounds);
          if (!found) continue;
          const bool is_alone = !found->kernel && !found->degenerate;
          const bool is_nearest =
              !system_.passive || is_alone || found->distance <= proposal.distance * (1.0 + tolerance::dc_same_distance);
          if (!best || found->distance < best->distance) best = std::move(found);
          if (is_nearest) return best;
        }
      }
    }
    return best;
  }

  /// In a passive system the solutions are a convex set: seen from two opposite sides of one of them, another is nearer, unless it is the only one.
  [[nodiscard]] bool is_unique(const Found& found) const {
    if (!found.kernel && !found.degenerate) return true;
    if (!system_.passive) return !found.kernel;
    Vector aside(system_.n);
    const double size = std::max(1.0, static_cast<double>(found.xi.norm()));
    for (Eigen::Index i = 0; i < aside.size(); ++i) aside[i] = size * std::sin(1.0 + 37.0 * static_cast<double>(i * i + 1));
    for (const double side : {1.0, -1.0}) {
      const auto other = nearest(found.xi.cast<double>() + side * aside);
      if (other && (other->xi - found.xi).norm() > tolerance::dc_same_state * size) return false;
    }
    return true;
  }

  [[nodiscard]] double doubt(const Found& found) const {
    return rounding_share(system_, zeta_, found.active, ports_.slowest_rate(), found.xi, found.u);
  }

 private:
  [[nodiscard]] std::optional<Found> solution_from(std::vector<int> active, const Vector& x0, int rounds) const {
    for (;; --rounds) {
      std::optional<Found> found = solution_of(active, x0);
      if (!found || found->wrong.empty()) return found;
      if (rounds == 0) return std::nullopt;
      std::vector<int> other;
      std::set_symmetric_difference(active.begin(), active.end(), found->wrong.begin(), found->wrong.end(), std::back_inserter(other));
      active = std::move(other);
    }
  }

  /// Of the mode, whatever its signs.
  [[nodiscard]] std::optional<Found> solution_of(const std::vector<int>& active, const Vector& x0) const {
    StaticModeSolution mode = solve_static_mode(system_, zeta_, active, x0, ports_.slowest_rate());
    if (!mode.exists) return std::nullopt;
    Found found{std::move(mode.xi), std::move(mode.u), 0.0, !mode.unique, false, active, {}};
    found.distance = static_cast<double>((found.xi - x0.cast<Wide>()).norm());
    judge_signs(found);
    return found;
  }

  void judge_signs(Found& found) const {
    const auto wide = system_.unrounded_matrices();
    const int d = system_.diodes;
    if (d == 0) return;
    WideVector x(system_.size());
    x << found.xi, zeta_.cast<Wide>();
    WideVector y = (wide->c * x + wide->d * found.u).head(d);
    const WideVector terms = (wide->c.cwiseAbs() * x.cwiseAbs() + wide->d.cwiseAbs() * found.u.cwiseAbs()).head(d);
    for (const int i : found.active)
      if (i < d) y[i] = 0;
    const Wide tolerance = tolerance::dc_sign * std::max({terms.maxCoeff(), found.u.cwiseAbs().maxCoeff(),
                                                          std::sqrt(Wide{ports_.slowest_rate()}) * found.xi.norm()});
    for (int i = 0; i < d; ++i) {
      if (std::find(blocked_.begin(), blocked_.end(), i) != blocked_.end()) continue;
      if (found.u[i] < -tolerance || y[i] < -tolerance) found.wrong.push_back(i);
      found.degenerate = found.degenerate || (found.u[i] <= tolerance && y[i] <= tolerance);
    }
  }

  const model::System& system_;
  const Vector& zeta_;
  const std::vector<char>& switch_active_;
  std::vector<int> blocked_;
  StaticPorts ports_;
};

}  // namespace

StaticSolution solve_static(const model::System& s, const Vector& zeta, const std::vector<char>& switch_active) {
  const StaticProblem problem(s, zeta, switch_active);
  StaticSolution solution;
  const auto found = problem.nearest(Vector::Zero(s.n));
  if (!found) {
    solution.status = StaticSolution::Status::none;
    return solution;
  }
  solution.unique = problem.is_unique(*found);
  solution.doubt = problem.doubt(*found);
  solution.x.resize(s.size());
  solution.x << found->xi.cast<double>(), zeta;
  solution.u = found->u.cast<double>();
  return solution;
}

}  // namespace pwlsim::engine
