#pragma once
/// The exact derivative of a run's end to its start: matrix exponentials over segments, and at instants
///
///     S = P + (f⁺ − P f⁻) n′/(n f⁻)      (saltation; P the product of the jumps' projections, n the guard that crosses zero),
///     S = P                               (where the time is fixed).
///
/// Aizerman & Gantmacher 1958; Leine & Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems (2004), §7.

#include <optional>
#include <string>
#include <vector>

#include "engine/exact/exact_model.hpp"
#include "steady/orbit_trace.hpp"

namespace pwlsim::steady {

using linalg::Matrix;
using linalg::Vector;

/// The places of the islands' ξ in the stacked state.
class Stacking {
 public:
  explicit Stacking(const engine::ExactModel& model);
  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] int first(std::size_t island) const { return first_[island]; }
  [[nodiscard]] int count(std::size_t island) const { return first_[island + 1] - first_[island]; }
  [[nodiscard]] const model::System& system(std::size_t island) const { return *systems_[island]; }
  [[nodiscard]] std::size_t islands() const { return systems_.size(); }
  [[nodiscard]] Vector stacked(const std::vector<Vector>& xi) const;
  [[nodiscard]] std::vector<Vector> apart(const Vector& x) const;

 private:
  std::vector<int> first_;
  std::vector<const model::System*> systems_;
  int size_ = 0;
};

/// A guard that crosses zero exactly at the instant of another event, but not in nearby runs.
struct Beside {
  double time = 0.0;  ///< s
  std::size_t island = 0;
  int guard = -1;  ///< row of the guards
};

struct Variation {
  Matrix x;                     ///< ∂(state at the end)/∂(state at the start) for a fixed end time
  Eigen::RowVectorXd end_time;  ///< ∂(time of the last instant)/∂(start)
  Vector flow;                  ///< ξ′ just after the end
  std::string kink;             ///< why there is no derivative; "" if there is one
  std::vector<Beside> beside;   ///< guards for which, or without which, there is another derivative
  /// ∂(state at the last instant)/∂(start): of the map from event to event.
  [[nodiscard]] Matrix return_map() const { return x + flow * end_time; }
};

/// (ξ, ζ)′ of the mode at y.
[[nodiscard]] Vector state_speed(const model::System& system, const model::Mode& mode, const std::vector<double>& y);
/// Its first part: ξ′.
[[nodiscard]] Vector store_speed(const model::System& system, const model::Mode& mode, const std::vector<double>& y);

/// Whether the guard of a change crosses zero rather than touches it: the mode changes or, if the switch is in another island, the switch.
[[nodiscard]] bool passes_guard(const model::System& system, const engine::Change& change, const std::vector<char>& on_before,
                                const std::vector<char>& on_after);

/// The row of the guard by which a control switches.
[[nodiscard]] int control_row(const model::System& system, std::size_t control, bool was_on);

/// The guard by which a change comes: of its own part or, where a switch of the part is driven by another part, of the other. Empty where the time is fixed, or another
/// part's guard takes it along. `near`: s.
struct Passage {
  const engine::Change* change = nullptr;  ///< one of `changes`
  int row = -1;
};
[[nodiscard]] std::optional<Passage> passage_of(const Stacking& stacking, const engine::Change& change,
                                                const std::vector<engine::Change>& changes, const std::vector<char>& on_before,
                                                const std::vector<char>& on, double near);

/// Rows of guards of `change.before` that cross zero within `near` (s) of the instant.
[[nodiscard]] std::vector<int> guards_beside(const engine::Change& change, double near);
/// Whether the effect of a change on a deviation depends on the exact time of the crossing: ξ′ changes, or a jump projects ξ.
[[nodiscard]] bool depends_on_order(const model::System& system, const engine::Change& change);

/// The start of a driven period, with the end of the period on its left.
[[nodiscard]] TraceStep wrap_of(const Trace& trace);

[[nodiscard]] Variation variation(const Stacking& stacking, const Trace& trace);

/// Whether a direction that passes the whole run unchanged changes a guard of some segment, of a diode or of a control, by more than rounding.
[[nodiscard]] bool moves_a_guard(const Stacking& stacking, const Trace& trace, const Vector& direction);

}  // namespace pwlsim::steady
