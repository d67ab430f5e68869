#include "engine/exact/segment_certifier.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "engine/exact/tolerances.hpp"
#include "model/valves.hpp"

namespace pwlsim::engine {

namespace {

using linalg::Matrix;
using linalg::Vector;

constexpr std::size_t most_samples = 16;
constexpr std::size_t most_first_visits = 32;
constexpr int most_panels = 8;      ///< of the energy quadrature; a longer stiff stretch is cut to its beginning
constexpr double panel_rate = 0.5;  ///< rate·panel: eight Gauss points are exact to rounding there

/// Gauss–Legendre, 8 points on [−1, 1] (Abramowitz & Stegun, table 25.4).
constexpr std::array<double, 4> gauss_point{0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
constexpr std::array<double, 4> gauss_weight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};

/// Everything the checks need at one state of one mode.
struct Point {
  Vector x, u, y, z;
};

Point evaluate(const IslandModel& island, const model::Mode& mode, const double* state) {
  const model::System& s = island.extraction.system;
  Point p;
  p.x.resize(s.size());
  model::from_mode(s, mode, state, p.x.data());
  p.u = mode.k * p.x;
  p.y = s.c * p.x + s.d * p.u;
  p.z = island.extraction.equations.z_state * p.x + island.extraction.equations.z_input * p.u;
  return p;
}

double stored(const model::Equations& d, const Vector& x) {
  const Vector full = d.store_state * x;
  return 0.5 * (d.store_sign.array() * full.array().square()).sum();
}

/// Sizes of an island's quantities over all its checked points: at the instant a current is about to start, or when all has come to
/// rest, everything is rounding, and only the run at large says against what.
struct Scale {
  double port = 0.0;
  double energy = 0.0;  ///< largest stored energy or throughput of a stretch
  Vector row, rate;

  void include(const Vector& rows, const Vector& rates, const Point& p) {
    if (row.size() == 0) row = Vector::Zero(rows.size());
    if (rate.size() == 0) rate = Vector::Zero(rates.size());
    row = row.cwiseMax(rows);
    rate = rate.cwiseMax(rates);
    if (p.u.size() > 0) port = std::max({port, p.u.cwiseAbs().maxCoeff(), p.y.cwiseAbs().maxCoeff()});
  }

  /// What the stores held before the first instant settled them; a run may begin by losing all of it.
  void include_start(const IslandModel& island, const Vector& x) {
    const model::Equations& d = island.extraction.equations;
    const Vector stores = d.store_state * x;
    energy = std::max(energy, stored(d, x));
    row = row.cwiseMax(d.f.cwiseAbs() * stores.cwiseAbs());
    const auto& s = island.extraction.system;
    rate = rate.cwiseMax(d.store_state.cwiseAbs() * (s.a.cwiseAbs() * x.cwiseAbs()));
    if (s.ports > 0) port = std::max(port, (s.c * x).cwiseAbs().maxCoeff());
  }
};

/// Beyond what rounding of the sums that u and y are can make: the current through a milliohm is a difference of large voltages.
double complementarity(const model::System& s, const model::Mode& mode, const Point& p) {
  double worst = 0.0;
  const Vector size_u = mode.k.cwiseAbs() * p.x.cwiseAbs();
  const Vector size_y = s.c.cwiseAbs() * p.x.cwiseAbs() + s.d.cwiseAbs() * size_u;
  const std::vector<int> blocked = model::blocked_ports(s, mode.active);
  for (int i = 0; i < s.ports; ++i) {
    const bool active = mode.active.contains(i);
    const bool is_diode = i < s.diodes && std::find(blocked.begin(), blocked.end(), i) == blocked.end();
    const double violation = is_diode ? std::abs(std::min(p.u[i], p.y[i])) : std::abs(active ? p.y[i] : p.u[i]);
    const double rounding = tolerance::sum_rounding * (p.u[i] < p.y[i] ? size_u[i] : size_y[i]);
    worst = std::max(worst, violation - rounding);
  }
  return worst;
}

/// Residuals of the original rows and of the stores' rates, with the magnitudes of their terms.
struct Residuals {
  Vector row, row_size, rate, rate_size;
};

Residuals kirchhoff(const IslandModel& island, const Point& p) {
  const model::System& s = island.extraction.system;
  const model::Equations& d = island.extraction.equations;
  const Vector stores = d.store_state * p.x;
  const Vector zeta = p.x.tail(s.n_zeta);
  const Vector wave = -(p.u + p.y);
  Residuals r;
  r.row = (d.f * stores + d.g * p.z + d.ha * wave + d.hw * zeta).cwiseAbs();
  r.row_size = d.f.cwiseAbs() * stores.cwiseAbs() + d.g.cwiseAbs() * p.z.cwiseAbs() + d.ha.cwiseAbs() * wave.cwiseAbs() +
               d.hw.cwiseAbs() * zeta.cwiseAbs();
  const Vector own = d.sx * p.z;
  r.rate = (d.store_state * (s.a * p.x + s.b * p.u) - own).cwiseAbs();
  r.rate_size = d.store_state.cwiseAbs() * (s.a.cwiseAbs() * p.x.cwiseAbs() + s.b.cwiseAbs() * p.u.cwiseAbs()) + own.cwiseAbs();
  return r;
}

double worst_relative(const Vector& residual, const Vector& size, double unit) {
  double worst = 0.0;
  const double floor = tolerance::idle_row * std::max(unit, size.size() > 0 ? size.maxCoeff() : 0.0);
  for (Eigen::Index i = 0; i < residual.size(); ++i)
    if (size[i] > 0.0) worst = std::max(worst, residual[i] / std::max(size[i], floor));
  return worst;
}

double power(const model::Equations& d, const Vector& z) {
  double sum = 0.0;
  for (const auto& store : d.store_ports) {
    const double v = (store.p == model::ground ? 0.0 : z[store.p]) - (store.n == model::ground ? 0.0 : z[store.n]);
    sum += v * z[store.current];
  }
  return sum / d.tau0;
}

struct EnergyBalance {
  double residual = 0.0, scale = 0.0;
};

EnergyBalance energy_balance(const IslandModel& island, const model::Mode& mode, const std::vector<double>& y0, double length) {
  const model::Equations& d = island.extraction.equations;
  if (d.store_ports.empty() || !(length > 0.0)) return {};
  const double rate = std::max(mode.flow.rate(), 1.0 / length);
  const int panels = static_cast<int>(std::clamp(std::ceil(rate * length / panel_rate), 1.0, static_cast<double>(most_panels)));
  const double panel = std::min(length / panels, panel_rate / rate);
  std::vector<double> work(2 * y0.size());
  const auto at = [&](double tau) {
    std::vector<double> y = y0;
    mode.flow.apply_once(tau, y.data(), work.data());
    return evaluate(island, mode, y.data());
  };
  double integral = 0.0;
  double throughput = 0.0;
  for (int i = 0; i < panels; ++i)
    for (std::size_t g = 0; g < gauss_point.size(); ++g)
      for (const double side : {-1.0, 1.0}) {
        const double value = power(d, at(panel * (i + 0.5 * (1.0 + side * gauss_point[g]))).z);
        integral += 0.5 * panel * gauss_weight[g] * value;
        throughput += 0.5 * panel * gauss_weight[g] * std::abs(value);
      }
  const double before = stored(d, at(0.0).x);
  const double after = stored(d, at(panel * panels).x);
  return {std::abs(after - before - integral), std::max({std::abs(before), std::abs(after), throughput})};
}

}  // namespace

void SegmentCertifier::start_is_known(const IslandAt& island) {
  starts_.emplace_back(&island.run.model(), Eigen::Map<const Vector>(island.run.x.data(), island.run.system().size()));
}

void SegmentCertifier::add(const IslandModel& island, const Segment& segment, double length) {
  const auto keep = [&](std::vector<Sample>& list) {
    const auto ny = static_cast<std::ptrdiff_t>(segment.mode->ny);
    list.push_back({&island, segment.mode, {segment.y0.begin(), segment.y0.begin() + ny}, length});
  };
  if (segment.mode->visits == 1 && first_visits_.size() < most_first_visits) return keep(first_visits_);
  if ((seen_++ & (stride_ - 1)) != 0) return;
  keep(samples_);
  if (samples_.size() < most_samples) return;
  for (std::size_t i = 1; 2 * i < samples_.size(); ++i) samples_[i] = std::move(samples_[2 * i]);
  samples_.resize(most_samples / 2);
  stride_ *= 2;
}

namespace {

/// Of an island: the worst residuals of each kind, and what they are relative to.
struct Worst {
  Scale scale;
  Vector row, rate;
  double port = 0.0, energy = 0.0;

  void include(const SegmentCertifier::Sample& sample);
  void judge(const IslandModel& island, Certificate& certificate) const;
};

constexpr double checked_at[] = {0.0, 0.5, 1.0};  ///< of a segment

void Worst::include(const SegmentCertifier::Sample& sample) {
  std::vector<double> work(2 * sample.y0.size());
  for (const double share : checked_at) {
    std::vector<double> y = sample.y0;
    if (share > 0.0) sample.mode->flow.apply_once(share * sample.length, y.data(), work.data());
    const Point point = evaluate(*sample.island, *sample.mode, y.data());
    const Residuals r = kirchhoff(*sample.island, point);
    scale.include(r.row_size, r.rate_size, point);
    row = row.size() == 0 ? r.row : Vector(row.cwiseMax(r.row));
    rate = rate.size() == 0 ? r.rate : Vector(rate.cwiseMax(r.rate));
    port = std::max(port, complementarity(sample.island->extraction.system, *sample.mode, point));
  }
  const EnergyBalance balance = energy_balance(*sample.island, *sample.mode, sample.y0, sample.length);
  energy = std::max(energy, balance.residual);
  scale.energy = std::max(scale.energy, balance.scale);
}

void Worst::judge(const IslandModel& island, Certificate& certificate) const {
  // Rates that the island's largest voltage would make: at rest they are rounding of that.
  const Matrix& sx = island.extraction.equations.sx;
  const double idle = tolerance::idle_row * (scale.row.size() > 0 ? scale.row.maxCoeff() : 0.0);
  const double unit_rate = sx.size() > 0 ? idle * sx.cwiseAbs().maxCoeff() : 0.0;
  certificate.kcl_kvl = std::max({certificate.kcl_kvl, worst_relative(row, scale.row, 0.0), worst_relative(rate, scale.rate, unit_rate)});
  const double largest_energy = std::max(scale.energy, 0.5 * idle * idle), largest_port = std::max(scale.port, idle);
  if (largest_energy > 0.0) certificate.energy = std::max(certificate.energy, energy / largest_energy);
  if (largest_port > 0.0) certificate.complementarity = std::max(certificate.complementarity, port / largest_port);
}

}  // namespace

Certificate SegmentCertifier::check() const {
  Certificate certificate;
  std::map<const IslandModel*, Worst> islands;
  for (const auto* list : {&first_visits_, &samples_})
    for (const Sample& sample : *list) {
      islands[sample.island].include(sample);
      certificate.points_checked += std::size(checked_at);
    }
  for (const auto& [island, state] : starts_)
    if (const auto found = islands.find(island); found != islands.end()) found->second.scale.include_start(*island, state);
  for (const auto& [island, worst] : islands) worst.judge(*island, certificate);
  return certificate;
}

}  // namespace pwlsim::engine
