/// ExactSegment: its search for the first passage of a guard.
#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/sparse/exact_segment.hpp"
#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

constexpr double first_look = 2.0, next_look = 4.0;  ///< how far events are looked for, of the expected length, and then of that
/// ‖A‖ times the length, beyond which the intervals of bounds of low order cost more than what it takes to leave out decays.
constexpr double most_time_constants = 1e3;
constexpr double share_of_rounding = 0.1;  ///< of a guard, in all decays that are over

}  // namespace

/// Most events come soon: what lies far beyond is looked at after that.
void ExactSegment::look(Segment& segment, double reach, Located& located) {
  for (double end = first_look * expected_; !located.found && segment.certified < reach; end *= next_look)
    locator_.locate(segment, std::min(end, reach), located);
}

const ExactSegment::Passage& ExactSegment::locate(double end) {
  if (located_) return passage_;
  located_ = true;
  const double reach = std::min(end, length_);
  Located located;
  if (!look_without_decays(reach, located)) look(segment_, reach, located);
  passage_ = {located.found, located.found ? located.tau : reach, located.row};
  if (located.found && begins_within_rounding(located.row)) passage_.tau = last_zero(located.row, located.tau);
  return passage_;
}

/// Whether rounding decides the sign of a guard at the start: it is found where it is visibly below zero.
bool ExactSegment::begins_within_rounding(int row) const {
  const auto at = std::find(segment_.rows.begin(), segment_.rows.end(), row);
  if (at == segment_.rows.end() || muted_.contains(row)) return false;
  return segment_.departures[static_cast<std::size_t>(at - segment_.rows.begin())].order < 0;
}

/// Before τ, where it is below; τ if it never was above.
double ExactSegment::last_zero(int row, double tau) {
  const std::vector<double> y = at(tau);
  double above = tau, below = tau, step = rounding_of(row, y) / std::abs(guard_rate(row, y));
  while (!(guard(row, at(above)) > 0.0)) {
    if (!(above > 0.0) || !(step > 0.0)) return tau;
    below = above;
    above = std::max(tau - step, 0.0);
    step *= 2.0;
  }
  while (below - above > tolerance::shortest_piece * tau) {
    const double middle = 0.5 * (above + below);
    (guard(row, at(middle)) > 0.0 ? above : below) = middle;
  }
  return below;
}

/// The most of the fastest decays that are over when the segment begins: what they add to a guard is below its rounding.
std::optional<linalg::WideFastPart> ExactSegment::decays_over(double reach) const {
  const linalg::Matrix& a = mode_->flow.a();
  const linalg::Rates& rates = space_.rates_of_motions();
  if (rates.empty()) return std::nullopt;
  const std::vector<linalg::Cut> cuts = linalg::find_cuts(rates, reach, 1.0 / reach);
  const linalg::WideVector y = Eigen::Map<const linalg::Vector>(segment_.y0.data(), a.rows()).cast<linalg::Wide>();
  for (std::size_t i = cuts.size(); i-- > 0;) {
    std::optional<linalg::WideFastPart> part = linalg::fast_part(a, cuts[i].fast);
    if (!part) continue;
    const linalg::WideVector decays = (part->coordinates * y).cwiseAbs();
    const auto is_over = [&](int row) {
      return (mode_->guards.row(row).cast<linalg::Wide>() * part->fast).cwiseAbs().dot(decays.transpose()) <=
             share_of_rounding * rounding_of(row, segment_.y0);
    };
    if (std::all_of(segment_.rows.begin(), segment_.rows.end(), is_over)) return part;
  }
  return std::nullopt;
}

/// Decays that are over leave the search to their rates, which are those of leaks behind windings at times, and to intervals of them: it goes on in what is slow, y = Q c. False: there are none.
bool ExactSegment::look_without_decays(double reach, Located& located) {
  if (segment_.rows.empty() || segment_.begins_sampled || !(mode_->norm_a * reach > most_time_constants)) return false;
  const std::optional<linalg::WideFastPart> part = decays_over(reach);
  if (!part) return false;
  const linalg::WideMatrix slow = linalg::complement(part->coordinates.transpose()), a = mode_->flow.a().cast<linalg::Wide>();
  const linalg::WideVector y = Eigen::Map<const linalg::Vector>(segment_.y0.data(), a.rows()).cast<linalg::Wide>();
  model::Mode mode;
  const linalg::Matrix of_slow = (slow.transpose() * a * slow).cast<double>();
  mode.flow = linalg::Exponential(of_slow, linalg::norm_bound(of_slow));
  mode.guards = linalg::product(mode_->guards.cast<linalg::Wide>(), slow).cast<double>();
  bound_mode(mode);
  Segment segment = segment_;
  segment.mode = &mode;
  const linalg::Vector c = (slow.transpose() * (y - part->fast * (part->coordinates * y))).cast<double>();
  segment.y0.assign(c.begin(), c.end());
  segment.y = segment.y0;
  mode.noise = mode_->noise;
  mode.guard_noise.setConstant(mode.guards.rows(), mode.noise);
  for (const int row : segment.rows) {
    const double size = model::guard_size(mode, row, c.data(), share_of_norm);
    if (size > 0.0) mode.guard_noise[row] = rounding_of(row, segment_.y0) / size;
  }
  std::vector<model::Departure> departures(segment.rows.size());
  model::Verifier().departures(mode, segment.y0.data(), segment.rows, departures.data());
  for (std::size_t i = 0; i < departures.size(); ++i) {
    if (segment.departures[i].order == 0) continue;
    segment.departures[i] = departures[i];
  }
  look(segment, reach, located);
  return true;
}

}  // namespace pwlsim::engine::sparse
