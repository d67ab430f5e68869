#include "steady/variation.hpp"
#include "steady/tolerances.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace pwlsim::steady {
namespace {

using model::Mode;
using model::System;

/// ∂ξ in coordinates of the mode, and back.
Matrix to_coordinates(const Mode& mode, const Matrix& x) { return mode.constrained ? Matrix(mode.basis.transpose() * x) : x; }
Matrix from_coordinates(const Mode& mode, const Matrix& c) { return mode.constrained ? Matrix(mode.basis * c) : c; }

/// e^{A₁τ} − I on the mode's own coordinates; segments of one mode and length share it.
class Propagators {
 public:
  const Matrix& of(const Mode& mode, double length) {
    Matrix& known = known_[{&mode, length}];
    if (known.size() > 0) return known;
    constexpr int many = 4;  // sources a state: a block of its own pays
    if (mode.ny <= many * mode.n1) return known = mode.flow.minus_identity(length).topLeftCorner(mode.n1, mode.n1);
    auto own = blocks_.find(&mode);
    if (own == blocks_.end())
      own = blocks_.emplace(&mode, linalg::Exponential(mode.flow.a().topLeftCorner(mode.n1, mode.n1), mode.flow.rate())).first;
    return known = own->second.minus_identity(length);
  }

 private:
  std::map<const Mode*, linalg::Exponential> blocks_;
  std::map<std::pair<const Mode*, double>, Matrix> known_;
};

/// Its first `count` entries of y′; inputs, of which there may be many, are zero.
Vector rate_of(const Mode& mode, const std::vector<double>& y, Eigen::Index count) {
  Vector rate(count);
  linalg::multiply_sparse(mode.flow.a(), y.data(), rate);
  return rate;
}
Vector rate_of(const Mode& mode, const std::vector<double>& y) { return rate_of(mode, y, mode.ny); }

class Walk {
 public:
  Walk(const Stacking& stacking, double length) : stacking_(stacking), length_(length) {
    result_.x = Matrix::Identity(stacking.size(), stacking.size());
    result_.end_time = Eigen::RowVectorXd::Zero(stacking.size());
    result_.flow = Vector::Zero(stacking.size());
  }

  void segment(const TraceSegment& s) {
    auto block = result_.x.middleRows(stacking_.first(s.island), stacking_.count(s.island));
    const Mode& mode = *s.mode;
    if (mode.n1 == 0) return;
    const Matrix c = to_coordinates(mode, block);
    block = from_coordinates(mode, Matrix(c + propagators_.of(mode, s.length) * c));
  }

  void step(const TraceStep& step) {
    const Eigen::RowVectorXd shift = time_shift(step);
    result_.end_time = shift;
    take_beside(step, shift);
    std::vector<Eigen::RowVectorXd> shifts;
    for (const engine::Change& change : step.changes) shifts.push_back(own_shift(change, step, shift));
    for (std::size_t k = 0; k < shifts.size(); ++k) pass(step.changes[k], shifts[k]);
    on_ = &step.on;
  }

  /// The end of the period, whose time is fixed.
  void look_at(const TraceStep& wrap) { take_beside(wrap, Eigen::RowVectorXd::Zero(stacking_.size())); }

  void take_flow(std::size_t island, const Mode& mode, const std::vector<double>& y) {
    result_.flow.segment(stacking_.first(island), stacking_.count(island)) =
        state_speed(stacking_.system(island), mode, y).head(stacking_.count(island));
  }

  Variation take() { return std::move(result_); }

 private:
  void kink(std::string why) {
    if (result_.kink.empty()) result_.kink = std::move(why);
  }

  /// δt of the instant: that of the first guard that is passed, where no source or clock fixes it.
  Eigen::RowVectorXd time_shift(const TraceStep& step) {
    for (const engine::Change& change : step.changes)
      if (change.cause == engine::Cause::guard &&
          passes_guard(stacking_.system(change.island), change, on_ != nullptr ? *on_ : step.on, step.on))
        return shift_of(change, step.time);
    for (const engine::Change& change : step.changes) {
      if (change.cause == engine::Cause::accumulation) kink(fmt::format("events accumulate at t = {} s", step.time));
      if (change.cause == engine::Cause::undecided && change.before != change.after)
        kink(fmt::format("the event at t = {} s could not be distinguished from others", step.time));
    }
    return Eigen::RowVectorXd::Zero(stacking_.size());
  }

  /// Guards that pass at the same time by chance: another deviation passes them apart.
  void take_beside(const TraceStep& step, const Eigen::RowVectorXd& shift) {
    for (const engine::Change& change : step.changes) {
      const System& system = stacking_.system(change.island);
      if (change.before == nullptr || change.before->n1 == 0 || !depends_on_order(system, change)) continue;
      for (const int row : guards_beside(change, tolerance::same_instant * (length_ + step.time))) {
        const Eigen::RowVectorXd own = shift_of(*change.before, row, change);
        const double state = Eigen::Map<const Vector>(change.y_before.data(), change.before->n1).norm();
        if (own.norm() * state <= tolerance::no_shift_row * length_) continue;
        if ((own - shift).norm() > tolerance::same_shift_row * (own.norm() + shift.norm()))
          result_.beside.push_back({step.time, change.island, row});
      }
    }
  }

  /// Of one change: parts that do not depend on one another may pass their guards at one instant, each by itself. `shift`: of the first guard.
  Eigen::RowVectorXd own_shift(const engine::Change& change, const TraceStep& step, const Eigen::RowVectorXd& shift) {
    if (change.cause == engine::Cause::time) return Eigen::RowVectorXd::Zero(stacking_.size());
    const std::vector<char>& before = on_ != nullptr ? *on_ : step.on;
    const auto passage = passage_of(stacking_, change, step.changes, before, step.on, tolerance::same_instant * (length_ + step.time));
    if (!passage) return shift;
    if (passage->change == &change) return shift_of(change, step.time);
    return shift_of(*passage->change->before, passage->row, *passage->change);
  }

  Eigen::RowVectorXd shift_of(const engine::Change& change, double time) {
    const Mode& mode = *change.before;
    const auto row = mode.guards.row(change.guard);
    const Vector rate = rate_of(mode, change.y_before);
    const double fall = row.dot(rate);
    if (mode.n1 == 0) return Eigen::RowVectorXd::Zero(stacking_.size());
    if (std::abs(fall) <= tolerance::touching * mode.guard_norm[change.guard] * rate.norm()) {
      kink(fmt::format("a guard is touched, not passed, at t = {} s", time));
      return Eigen::RowVectorXd::Zero(stacking_.size());
    }
    return shift_of(mode, change.guard, change);
  }

  Eigen::RowVectorXd shift_of(const Mode& mode, int guard, const engine::Change& change) {
    const auto row = mode.guards.row(guard);
    const double fall = row.dot(rate_of(mode, change.y_before));
    const auto block = result_.x.middleRows(stacking_.first(change.island), stacking_.count(change.island));
    return row.head(mode.n1) * to_coordinates(mode, block) * (-1.0 / fall);
  }

  void pass(const engine::Change& change, const Eigen::RowVectorXd& shift) {
    const System& system = stacking_.system(change.island);
    const int n = stacking_.count(change.island);
    if (n == 0) return;
    auto block = result_.x.middleRows(stacking_.first(change.island), n);
    Vector before = Vector::Zero(system.size());
    if (change.before && !change.y_before.empty()) before = state_speed(system, *change.before, change.y_before);
    for (const Mode* mode : change.by_way_of) {
      if (!mode->constrained) continue;
      block = mode->projector.topLeftCorner(n, n) * block;
      before = mode->projector * before;
    }
    const Vector after = state_speed(system, *change.after, change.y_after);
    if (change.before) block += (before - after).head(n) * shift;
    result_.flow.segment(stacking_.first(change.island), n) = after.head(n);
  }

  const Stacking& stacking_;
  double length_;
  Propagators propagators_;
  Variation result_;
  const std::vector<char>* on_ = nullptr;  ///< switches left of the instant
};

}  // namespace

Stacking::Stacking(const engine::ExactModel& model) {
  for (const engine::IslandModel& island : model.islands) {
    first_.push_back(size_);
    systems_.push_back(&island.extraction.system);
    size_ += island.extraction.system.n;
  }
  first_.push_back(size_);
}

Vector Stacking::stacked(const std::vector<Vector>& xi) const {
  Vector x(size_);
  for (std::size_t i = 0; i < xi.size(); ++i) x.segment(first(i), count(i)) = xi[i];
  return x;
}

std::vector<Vector> Stacking::apart(const Vector& x) const {
  std::vector<Vector> xi;
  for (std::size_t i = 0; i < islands(); ++i) xi.emplace_back(x.segment(first(i), count(i)));
  return xi;
}

bool passes_guard(const System& system, const engine::Change& change, const std::vector<char>& on_before,
                  const std::vector<char>& on_after) {
  if (change.before != change.after) return true;
  for (const Mode* const way : change.by_way_of)
    if (way != change.before) return true;  // and back again at once
  if (change.guard < system.diodes) return false;
  const auto driven = static_cast<std::size_t>(system.controls[static_cast<std::size_t>(change.guard - system.diodes) / 2].driven);
  return on_before[driven] != on_after[driven];
}

Vector state_speed(const model::System& system, const model::Mode& mode, const std::vector<double>& y) {
  const Vector rate = rate_of(mode, y);
  Vector x(system.size());
  model::from_mode(system, mode, rate.data(), x.data());
  return x;
}

Vector store_speed(const model::System& system, const model::Mode& mode, const std::vector<double>& y) {
  if (mode.constrained) return state_speed(system, mode, y).head(system.n);
  return rate_of(mode, y, mode.n1);
}

int control_row(const System& system, std::size_t control, bool was_on) {
  return system.diodes + static_cast<int>(2 * control) + (was_on ? 0 : 1);
}

namespace {

/// The guard by which a part's signals change a switch at this instant.
std::optional<int> passed_row(const System& system, const engine::Change& change, int driven, bool was_on, double near) {
  if (change.cause != engine::Cause::guard || change.before == nullptr || change.y_before.empty() || change.before->n1 == 0)
    return std::nullopt;
  const Mode& mode = *change.before;
  const Vector rate = rate_of(mode, change.y_before);
  for (std::size_t k = 0; k < system.controls.size(); ++k) {
    const int row = control_row(system, k, was_on);
    if (system.controls[k].driven != driven || row >= mode.guards.rows()) continue;
    const double value = mode.guards.row(row).dot(Eigen::Map<const Vector>(change.y_before.data(), mode.ny));
    const double fall = mode.guards.row(row).dot(rate);
    if (std::abs(fall) > tolerance::touching * mode.guard_norm[row] * rate.norm() && std::abs(value) <= near * std::abs(fall)) return row;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Passage> passage_of(const Stacking& stacking, const engine::Change& change, const std::vector<engine::Change>& changes,
                                  const std::vector<char>& on_before, const std::vector<char>& on, double near) {
  const System& system = stacking.system(change.island);
  if (change.cause == engine::Cause::time) return std::nullopt;
  if (change.cause == engine::Cause::guard)
    return passes_guard(system, change, on_before, on) ? std::optional(Passage{&change, change.guard}) : std::nullopt;
  for (const int number : system.switch_number)
    if (const auto driven = static_cast<std::size_t>(number); on_before[driven] != on[driven])
      for (const engine::Change& other : changes)
        if (const auto row = passed_row(stacking.system(other.island), other, number, on_before[driven] != 0, near))
          return Passage{&other, *row};
  return std::nullopt;
}

std::vector<int> guards_beside(const engine::Change& change, double near) {
  std::vector<int> rows;
  if (change.before == nullptr || change.y_before.empty()) return rows;
  const Mode& mode = *change.before;
  if (mode.n1 == 0) return rows;
  const Vector rate = rate_of(mode, change.y_before);
  const double size = rate.norm();
  Vector fall(mode.guards.rows()), value(mode.guards.rows());
  linalg::multiply(mode.guards, rate.data(), fall.data());
  linalg::multiply(mode.guards, change.y_before.data(), value.data());
  for (int row = 0; row < mode.guards.rows(); ++row) {
    if (mode.guard_constant[static_cast<std::size_t>(row)] != 0 || mode.guard_norm[row] == 0.0) continue;
    if (!(fall[row] < -tolerance::touching * mode.guard_norm[row] * size)) continue;
    if (std::abs(value[row]) <= -fall[row] * near) rows.push_back(row);
  }
  return rows;
}

bool depends_on_order(const System& system, const engine::Change& change) {
  if (change.before == nullptr || change.y_before.empty()) return false;
  Vector before = state_speed(system, *change.before, change.y_before);
  const Vector after = state_speed(system, *change.after, change.y_after);
  bool projects = false;
  for (const Mode* mode : change.by_way_of) {
    if (!mode->constrained) continue;
    before = mode->projector * before;
    projects |= mode != change.before;
  }
  return projects ||
         (before - after).head(system.n).norm() > tolerance::same_speed * (before.head(system.n).norm() + after.head(system.n).norm());
}

TraceStep wrap_of(const Trace& trace) {
  TraceStep wrap = trace.steps.front();
  for (engine::Change& change : wrap.changes)
    for (const TraceSegment& segment : trace.tail)
      if (segment.island == change.island) {
        change.before = segment.mode;
        change.y_before = segment.y1;
        change.cause = engine::Cause::time;
      }
  return wrap;
}

Variation variation(const Stacking& stacking, const Trace& trace) {
  double length = 0.0;
  for (const TraceSegment& segment : trace.tail) length = std::max(length, segment.begin + segment.length);
  if (!trace.steps.empty()) length = std::max(length, trace.steps.back().time);
  Walk walk(stacking, length);
  for (const TraceStep& step : trace.steps) {
    for (const TraceSegment& segment : step.segments) walk.segment(segment);
    walk.step(step);
  }
  for (const TraceSegment& segment : trace.tail) {
    walk.segment(segment);
    walk.take_flow(segment.island, *segment.mode, segment.y1);
  }
  if (!trace.tail.empty() && !trace.steps.empty()) walk.look_at(wrap_of(trace));
  return walk.take();
}

bool moves_a_guard(const Stacking& stacking, const Trace& trace, const Vector& direction) {
  Vector v = direction;
  const auto moves = [&](const TraceSegment& s) {
    const Mode& mode = *s.mode;
    auto block = v.segment(stacking.first(s.island), stacking.count(s.island));
    if (mode.n1 == 0) return false;
    Vector c = to_coordinates(mode, block);
    const auto moves_now = [&] {
      for (Eigen::Index i = 0; i < mode.guards.rows(); ++i)
        if (std::abs(mode.guards.row(i).head(mode.n1).dot(c)) > tolerance::unmoved_guard * mode.guard_norm[i] * direction.norm())
          return true;
      return false;
    };
    if (moves_now()) return true;
    c += mode.flow.minus_identity(s.length).topLeftCorner(mode.n1, mode.n1) * c;
    block = from_coordinates(mode, c);
    return moves_now();
  };
  for (const TraceStep& step : trace.steps)
    for (const TraceSegment& segment : step.segments)
      if (moves(segment)) return true;
  for (const TraceSegment& segment : trace.tail)
    if (moves(segment)) return true;
  return false;
}

}  // namespace pwlsim::steady
