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

constexpr std::size_t most_sampled_segments = 16;
constexpr std::size_t most_first_visits = 32;
constexpr int most_panels = 4;      ///< of the energy quadrature; a longer stiff stretch is cut to its beginning
constexpr double panel_rate = 0.5;  ///< rate·panel: eight Gauss points are exact to rounding there

constexpr int panel_terms = 18;                   ///< of a panel: panel_rate¹⁸/18! is 10⁻²¹
constexpr double checked_at[] = {0.0, 0.5, 1.0};  ///< of a segment

/// Gauss–Legendre, 8 points on [−1, 1] (Abramowitz & Stegun, table 25.4).
constexpr std::array<double, 4> gauss_point{0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
constexpr std::array<double, 4> gauss_weight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};

/// Everything the checks need at states of one mode, one a column.
struct Points {
  Matrix x, u, y, z;
};

/// x and u of the mode's states, one a column.
Points locate_points(const model::System& s, const model::Mode& mode, const Matrix& states) {
  Points p;
  p.x.resize(s.size(), states.cols());
  for (Eigen::Index j = 0; j < states.cols(); ++j) model::from_mode(s, mode, states.col(j).data(), p.x.col(j).data());
  p.u = mode.k * p.x;
  return p;
}

double stored(const model::Equations& d, const Vector& x) {
  const Vector full = d.store_state * x;
  return 0.5 * (d.store_sign.array() * full.array().square()).sum();
}

/// What the checks need of an island's matrices: their sizes, and the rows of z that are voltages and currents of stores.
struct Rows {
  explicit Rows(const IslandModel& island);

  Matrix f, g, ha, hw, store_state, a, b, c, d;
  Matrix voltage_of_x, voltage_of_u, current_of_x, current_of_u;
};

Rows::Rows(const IslandModel& island) {
  const model::System& s = island.extraction.system;
  const model::Equations& e = island.extraction.equations;
  for (const auto& [size, matrix] : {std::pair{&f, &e.f},
                                     {&g, &e.g},
                                     {&ha, &e.ha},
                                     {&hw, &e.hw},
                                     {&store_state, &e.store_state},
                                     {&a, &s.a},
                                     {&b, &s.b},
                                     {&c, &s.c},
                                     {&d, &s.d}})
    *size = matrix->cwiseAbs();
  const auto stores = static_cast<Eigen::Index>(e.store_ports.size());
  const auto take = [&](const Matrix& z, Matrix& voltage, Matrix& current) {
    voltage = Matrix::Zero(stores, z.cols());
    current.resize(stores, z.cols());
    for (Eigen::Index i = 0; i < stores; ++i) {
      const auto& store = e.store_ports[static_cast<std::size_t>(i)];
      if (store.p != model::ground) voltage.row(i) += z.row(store.p);
      if (store.n != model::ground) voltage.row(i) -= z.row(store.n);
      current.row(i) = z.row(store.current);
    }
  };
  take(e.z_state, voltage_of_x, current_of_x);
  take(e.z_input, voltage_of_u, current_of_u);
}

/// Sizes of an island's quantities over all its checked points: at the instant a current is about to start, or when all has come to
/// rest, everything is rounding, and only the run at large says against what.
struct Scale {
  double port = 0.0;
  double energy = 0.0;  ///< largest stored energy or throughput of a stretch
  Vector row, rate;

  void include(const Matrix& rows, const Matrix& rates, const Points& p) {
    if (row.size() == 0) row = Vector::Zero(rows.rows());
    if (rate.size() == 0) rate = Vector::Zero(rates.rows());
    row = row.cwiseMax(rows.rowwise().maxCoeff());
    rate = rate.cwiseMax(rates.rowwise().maxCoeff());
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
double complementarity(const model::System& s, const Rows& rows, const model::Mode& mode, const Points& p) {
  double worst = 0.0;
  const Matrix size_x = p.x.cwiseAbs();
  const Matrix size_u = mode.k.cwiseAbs() * size_x;
  const Matrix size_y = rows.c * size_x + rows.d * size_u;
  const std::vector<int> blocked = model::blocked_ports(s, mode.active);
  for (int i = 0; i < s.ports; ++i) {
    const bool active = mode.active.contains(i);
    const bool is_diode = i < s.diodes && std::find(blocked.begin(), blocked.end(), i) == blocked.end();
    for (Eigen::Index j = 0; j < p.u.cols(); ++j) {
      const double u = p.u(i, j), y = p.y(i, j);
      const double violation = is_diode ? std::abs(std::min(u, y)) : std::abs(active ? y : u);
      worst = std::max(worst, violation - tolerance::sum_rounding * (u < y ? size_u(i, j) : size_y(i, j)));
    }
  }
  return worst;
}

/// Residuals of the original rows and of the stores' rates, with the magnitudes of their terms; one point a column.
struct Residuals {
  Matrix row, row_size, rate, rate_size;
};

Residuals kirchhoff(const IslandModel& island, const Rows& rows, const Points& p) {
  const model::System& s = island.extraction.system;
  const model::Equations& d = island.extraction.equations;
  const Matrix stores = d.store_state * p.x;
  const auto zeta = p.x.bottomRows(s.n_zeta);
  const Matrix wave = -(p.u + p.y);
  Residuals r;
  r.row = (d.f * stores + d.g * p.z + d.ha * wave + d.hw * zeta).cwiseAbs();
  r.row_size = rows.f * stores.cwiseAbs() + rows.g * p.z.cwiseAbs() + rows.ha * wave.cwiseAbs() + rows.hw * zeta.cwiseAbs();
  const Matrix own = d.sx * p.z;
  r.rate = (d.store_state * (s.a * p.x + s.b * p.u) - own).cwiseAbs();
  r.rate_size = rows.store_state * (rows.a * p.x.cwiseAbs() + rows.b * p.u.cwiseAbs()) + own.cwiseAbs();
  return r;
}

double worst_relative(const Vector& residual, const Vector& size, double unit) {
  double worst = 0.0;
  const double floor = tolerance::idle_row * std::max(unit, size.size() > 0 ? size.maxCoeff() : 0.0);
  for (Eigen::Index i = 0; i < residual.size(); ++i)
    if (size[i] > 0.0) worst = std::max(worst, residual[i] / std::max(size[i], floor));
  return worst;
}

struct EnergyBalance {
  double residual = 0.0, scale = 0.0;
};

/// τ^k/k! at the Gauss points and, last, at the end of a panel from 0 to 1 (terms × 9).
Matrix series_at_points() {
  Vector points(2 * gauss_point.size() + 1);
  for (std::size_t g = 0; g < gauss_point.size(); ++g) {
    points[static_cast<Eigen::Index>(2 * g)] = 0.5 * (1.0 - gauss_point[g]);
    points[static_cast<Eigen::Index>(2 * g + 1)] = 0.5 * (1.0 + gauss_point[g]);
  }
  points[points.size() - 1] = 1.0;
  Matrix series = Matrix::Ones(panel_terms, points.size());
  for (int k = 1; k < panel_terms; ++k) series.row(k) = series.row(k - 1).cwiseProduct(points.transpose()) / k;
  return series;
}

/// The stored energy's change by the run's own exponential, against the power into the stores, integrated over Taylor's series.
EnergyBalance energy_balance(const IslandModel& island, const Rows& rows, const model::Mode& mode, const std::vector<double>& y0,
                             double length) {
  const model::Equations& d = island.extraction.equations;
  const model::System& s = island.extraction.system;
  if (d.store_ports.empty() || !(length > 0.0)) return {};
  static const Matrix series = series_at_points();
  const double rate = std::max(mode.flow.rate(), 1.0 / length);
  const int panels = static_cast<int>(std::clamp(std::ceil(rate * length / panel_rate), 1.0, static_cast<double>(most_panels)));
  const double panel = std::min(length / panels, panel_rate / rate);
  const auto ny = static_cast<Eigen::Index>(y0.size());
  const Matrix step = panel * mode.flow.a();
  Matrix derivatives(ny, panel_terms);  // times panel^k
  derivatives.col(0) = Eigen::Map<const Vector>(y0.data(), ny);
  double integral = 0.0;
  double throughput = 0.0;
  for (int i = 0; i < panels; ++i) {
    linalg::multiply_repeatedly(step, panel_terms - 1, derivatives.data());
    const Matrix states = derivatives * series;
    const Points p = locate_points(s, mode, states.leftCols(series.cols() - 1));
    const Matrix voltage = rows.voltage_of_x * p.x + rows.voltage_of_u * p.u, current = rows.current_of_x * p.x + rows.current_of_u * p.u;
    for (Eigen::Index j = 0; j < voltage.cols(); ++j) {
      const double share = 0.5 * panel * gauss_weight[static_cast<std::size_t>(j / 2)] / d.tau0;
      const double value = voltage.col(j).dot(current.col(j));
      integral += share * value;
      throughput += share * std::abs(value);
    }
    derivatives.col(0) = states.col(series.cols() - 1);
  }
  Matrix ends(ny, 2);
  ends.colwise() = Eigen::Map<const Vector>(y0.data(), ny);
  std::vector<double> work(2 * y0.size());
  mode.flow.apply_once(panel * panels, ends.col(1).data(), work.data());
  const Matrix x = locate_points(s, mode, ends).x;
  const double before = stored(d, x.col(0)), after = stored(d, x.col(1));
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
  if (samples_.size() < most_sampled_segments) return;
  for (std::size_t i = 1; 2 * i < samples_.size(); ++i) samples_[i] = std::move(samples_[2 * i]);
  samples_.resize(most_sampled_segments / 2);
  stride_ *= 2;
}

namespace {

/// Of an island: the worst residuals of each kind, and what they are relative to.
struct Worst {
  explicit Worst(const IslandModel& island) : rows(island) {}

  Rows rows;
  Scale scale;
  Vector row, rate;
  double port = 0.0, energy = 0.0;

  void include(const SegmentCertifier::Sample& sample);
  void judge(const IslandModel& island, Certificate& certificate) const;
};

void Worst::include(const SegmentCertifier::Sample& sample) {
  const model::System& s = sample.island->extraction.system;
  const model::Equations& d = sample.island->extraction.equations;
  const auto ny = static_cast<Eigen::Index>(sample.y0.size());
  std::vector<double> work(2 * sample.y0.size());
  Matrix states(ny, std::size(checked_at));
  for (Eigen::Index j = 0; j < states.cols(); ++j) {
    states.col(j) = Eigen::Map<const Vector>(sample.y0.data(), ny);
    const double share = checked_at[j];
    if (share > 0.0) sample.mode->flow.apply_once(share * sample.length, states.col(j).data(), work.data());
  }
  Points points = locate_points(s, *sample.mode, states);
  points.y = s.c * points.x + s.d * points.u;
  points.z = d.z_state * points.x + d.z_input * points.u;
  const Residuals r = kirchhoff(*sample.island, rows, points);
  scale.include(r.row_size, r.rate_size, points);
  const Vector largest_row = r.row.rowwise().maxCoeff(), largest_rate = r.rate.rowwise().maxCoeff();
  row = row.size() == 0 ? largest_row : Vector(row.cwiseMax(largest_row));
  rate = rate.size() == 0 ? largest_rate : Vector(rate.cwiseMax(largest_rate));
  port = std::max(port, complementarity(s, rows, *sample.mode, points));
  const EnergyBalance balance = energy_balance(*sample.island, rows, *sample.mode, sample.y0, sample.length);
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
      islands.try_emplace(sample.island, *sample.island).first->second.include(sample);
      certificate.points_checked += std::size(checked_at);
    }
  for (const auto& [island, state] : starts_)
    if (const auto found = islands.find(island); found != islands.end()) found->second.scale.include_start(*island, state);
  for (const auto& [island, worst] : islands) worst.judge(*island, certificate);
  return certificate;
}

}  // namespace pwlsim::engine
