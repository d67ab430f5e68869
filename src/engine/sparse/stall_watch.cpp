#include "engine/sparse/stall_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace pwlsim::engine::sparse {

namespace {

/// So many steps within that part of the run, and residuals of the certificate of that size (and of so many tolerances): they lead nowhere.
constexpr std::uint64_t steps_between_looks = 50'000;
constexpr double short_stretch = 2.5e-4, hopeless_residual = 1e-3, hopeless_tolerances = 10.0;
/// Wrong altogether, or in Kirchhoff's laws, which solutions keep to rounding: then it need not get worse to be given up.
constexpr double slow_stretch = 1e-2, senseless_residual = 0.5, broken_laws = 1e-6;
/// So many of them that stand at a cliff: the next longer one is so much worse, as no power of the step makes it, for want of a position. Unless events
/// come of it.
constexpr double cliff = 1e6;
constexpr std::uint64_t most_cliffs = steps_between_looks / 4, few_events = steps_between_looks / 500;
/// Without events, in an active network, at so many looks in a row: the remaining run would take a million times that many steps. A ring may die down meanwhile.
constexpr double hopeless_stretch = 1e-6;
constexpr int most_stuck_looks = 20;
/// Nearly every second one leads to a passage after which every port stays on its side, or, in a passive network too, stands at a cliff, between so many
/// looks in a row.
constexpr std::uint64_t many_idle = steps_between_looks * 2 / 5;
constexpr int most_idle_looks = 2;
constexpr double idle_stretch = 0.05;
/// So many passages in a row after which every port stays on its side: with such residuals it should not have stayed there.
constexpr int most_idle_passages = 2'000;

/// The worse of complementarity and Kirchhoff's laws, relative.
double worst_residual(const Certificate& certificate) { return std::max(certificate.complementarity, certificate.kcl_kvl); }

/// Looks in a row of which that is true.
void count_in_a_row(int& looks, bool is_true) { looks = is_true ? looks + 1 : 0; }

}  // namespace

StallWatch::StallWatch(bool is_passive, double stop, double reltol) : passive_(is_passive), stop_(stop), reltol_(reltol) {}

void StallWatch::note_errors(double error, double rejected_error) {
  if (rejected_error > cliff * error) ++cliffs_;
}

void StallWatch::note_instant(bool happened) {
  idle_passages_ = happened ? 0 : idle_passages_ + 1;
  if (!happened) ++idle_since_;
}

/// Since the last look.
bool StallWatch::are_steps_many(const Progress& now) const { return now.steps - last_.steps >= steps_between_looks; }

bool StallWatch::are_passages_idle() const { return idle_passages_ >= most_idle_passages; }

bool StallWatch::is_due(const Progress& now) const { return are_steps_many(now) || are_passages_idle(); }

std::string StallWatch::look(const Certificate& certificate, const Progress& now) {
  if (are_steps_many(now)) {
    const double stretch = now.time - last_.time;
    const std::string why = look_at_steps(certificate, now, stretch);
    if (!why.empty())
      return fmt::format("steps become too short before t = {} s ({} of them within {:.3g} s), and {}", now.time, steps_between_looks,
                         stretch, why);
  }
  return are_passages_idle() ? look_at_passages(certificate, now) : "";
}

/// They took that much of the run.
std::string StallWatch::look_at_steps(const Certificate& certificate, const Progress& now, double stretch) {
  const double worst = worst_residual(certificate);
  const bool is_worse = worst > std::exchange(residual_before_, worst);
  const bool is_senseless = worst >= senseless_residual || certificate.kcl_kvl >= broken_laws;
  const bool is_quiet = now.events - last_.events < few_events;
  last_ = now;
  const std::uint64_t idle = std::exchange(idle_since_, 0), cliffs = std::exchange(cliffs_, 0);
  count_in_a_row(idle_looks_, idle > many_idle);
  count_in_a_row(cliff_looks_, cliffs > many_idle);
  count_in_a_row(stuck_looks_, is_quiet && !passive_ && stretch <= hopeless_stretch * stop_);
  const bool is_blocked = is_quiet && (passive_ ? cliff_looks_ >= most_idle_looks : cliffs > most_cliffs);
  if (stuck_looks_ >= most_stuck_looks)
    return fmt::format("the remaining run would take {:.0e} of them",
                       static_cast<double>(steps_between_looks) * (stop_ - now.time) / stretch);
  if (is_quiet && idle_looks_ >= most_idle_looks && stretch <= idle_stretch * stop_)
    return fmt::format("for {} of them no position of the ports is valid", idle);
  if (stretch > (is_senseless || is_blocked ? slow_stretch : short_stretch) * stop_) return "";
  if (is_senseless || (is_worse && is_hopeless(worst))) return fmt::format("violate the circuit's laws by {:.1e}", worst);
  return is_blocked ? "longer ones find no position, or a different one" : "";
}

std::string StallWatch::look_at_passages(const Certificate& certificate, const Progress& now) {
  idle_passages_ = 0;
  const double worst = worst_residual(certificate);
  if (!is_hopeless(worst)) return "";
  return fmt::format("the ports find no valid position before t = {} s ({} times), and violate the circuit's laws by {:.1e}", now.time,
                     most_idle_passages, worst);
}

bool StallWatch::is_hopeless(double residual) const { return residual >= std::max(hopeless_residual, hopeless_tolerances * reltol_); }

}  // namespace pwlsim::engine::sparse
