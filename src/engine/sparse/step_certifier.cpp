#include "engine/sparse/step_certifier.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/arithmetic.hpp"
#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

constexpr std::uint64_t points_per_stride = 64;

}  // namespace

bool StepCertifier::sampled() {
  if (seen_++ % stride_ != 0) return false;
  if (++points_ % points_per_stride == 0) stride_ *= 2;
  return true;
}

void StepCertifier::add_step(const Point& from, const Stepper::Trial& trial, const Point& reached, const PortSolver& ports) {
  if (!sampled()) return;
  add_rows(trial.end);
  add_ports(reached, ports);
  add_energy(from, trial);
}

void StepCertifier::add_point(const Point& point, const PortSolver& ports, const SegmentTimes& times, std::span<const int> rising) {
  if (!sampled()) return;
  add_rows(point, times);
  add_ports(point, ports, rising);
}

void StepCertifier::add_rows(const Point& point, const SegmentTimes& times) {
  const auto n = static_cast<std::size_t>(descriptor_.size());
  for (auto* v : {&rows_.residual, &rows_.moved, &rows_.size}) v->resize(n, 0.0);
  for (auto* v : {&rates_, &row_size_}) v->resize(n);
  descriptor_.rates(point.z.data(), point.w.data(), rates_.data());
  descriptor_.rate_sizes(point.z.data(), point.w.data(), row_size_.data());
  for (int node = 0; node < descriptor_.nodes(); ++node)
    rows_.voltage = std::max(rows_.voltage, std::abs(point.z[static_cast<std::size_t>(node)]));
  for (std::size_t i = 0; i < n; ++i) {
    const double rounding = point.k_sizes.empty() ? 0.0 : tolerance::unknown_rounding * point.k_sizes[i];
    const double residual = std::max(std::abs(point.k[i] - rates_[i]) - rounding, 0.0);
    rows_.residual[i] = std::max(rows_.residual[i], residual);
    if (residual > 0.0) rows_.moved[i] = std::max(rows_.moved[i], residual * times.followed);
    rows_.size[i] = std::max(rows_.size[i], std::abs(point.k[i]) + row_size_[i]);
  }
  if (!(times.length < INFINITY)) return;
  descriptor_.memory(point.z.data(), rates_.data());
  const double twice_energy = std::max(descriptor_.product(point.z, rates_), 0.0);
  rows_.twice_energy = std::max(rows_.twice_energy, twice_energy);
  for (std::size_t i = 0; i < n; ++i)
    rows_.size[i] =
        std::max(rows_.size[i], std::max(std::abs(rates_[i]), std::sqrt(std::max(stores_[i], 0.0) * twice_energy)) / times.length);
}

double StepCertifier::row_residual(const Point& point, const SegmentTimes& times) {
  Rows kept = rows_;
  rows_.residual.clear();
  rows_.moved.clear();
  add_rows(point, times);
  std::swap(rows_, kept);
  return largest_residual(kept);
}

/// Of the largest voltage and the largest other unknown of a point, in volts.
StepCertifier::Rounding StepCertifier::rounding_at(const Point& point) const {
  if (least_ == 0.0) return {};
  const std::span z(point.z);
  const auto nodes = static_cast<std::size_t>(descriptor_.nodes());
  return {tolerance::unknown_rounding * std::max(least_, largest(z.first(nodes))),
          tolerance::unknown_rounding * std::max(least_, largest(z.subspan(nodes)))};
}

void StepCertifier::add_ports(const Point& point, const PortSolver& ports, std::span<const int> rising) {
  const Rounding rounding = rounding_at(point);
  for (int i = 0; i < descriptor_.first_switch(); ++i) {
    if (std::find(rising.begin(), rising.end(), i) != rising.end()) continue;
    const DescriptorPort& port = descriptor_.ports()[static_cast<std::size_t>(i)];
    const auto beyond = [](double value, double zero) { return std::abs(value) > zero ? value : 0.0; };
    const double u = beyond(point.z[static_cast<std::size_t>(port.row)], rounding.input);
    const double s = beyond(port.slack.value(point.z.data(), point.w.data()), rounding.voltage);
    const bool on = point.on[static_cast<std::size_t>(i)] != 0;
    if (port.blocks(point.on)) {
      input_ = std::max(input_, std::abs(u));
      continue;
    }
    input_ = std::max(input_, on ? -u : std::abs(u));
    slack_ = std::max(slack_, on ? std::abs(s) : -s);
    input_scale_ = std::max({input_scale_, std::abs(u), ports.scale().input});
    slack_scale_ = std::max({slack_scale_, std::abs(s), ports.scale().slack});
  }
}

double StepCertifier::energy(const Point& point) {
  descriptor_.memory(point.z.data(), rates_.data());
  return 0.5 * descriptor_.product(point.z, rates_);
}

void StepCertifier::add_energy(const Point& from, const Stepper::Trial& trial) {
  const double h = trial.end.time - from.time;
  const double before = energy(from), after = energy(trial.end);
  const double flow[3] = {h * step_weight * descriptor_.product(from.z, from.k),
                          h * step_weight * descriptor_.product(trial.stage.z, trial.stage.k),
                          h * diagonal * descriptor_.product(trial.end.z, trial.end.k)};
  energy_ = std::max(energy_, std::abs(after - before - flow[0] - flow[1] - flow[2]));
  energy_scale_ = std::max({energy_scale_, std::abs(before), std::abs(after), std::abs(flow[0]) + std::abs(flow[1]) + std::abs(flow[2])});
}

double StepCertifier::largest_residual(const Rows& rows) const {
  const double most = rows.size.empty() ? 0.0 : std::max(rows.voltage, *std::max_element(rows.size.begin(), rows.size.end()));
  double worst = 0.0;
  for (std::size_t i = 0; i < rows.residual.size(); ++i) {
    if (!(rows.size[i] > 0.0 && rows.residual[i] > tolerance::unknown_rounding * least_)) continue;
    const double of_terms = rows.residual[i] / std::max(rows.size[i], tolerance::idle_row * most);
    const double store = std::sqrt(std::max(stores_[i], 0.0) * rows.twice_energy);
    worst = std::max(worst, store > 0.0 ? std::min(of_terms, rows.moved[i] / store) : of_terms);
  }
  return worst;
}

Certificate StepCertifier::check() const {
  Certificate certificate;
  certificate.points_checked = points_;
  const double input_scale = std::max(input_scale_, tolerance::idle_row * slack_scale_);  // where no current ever flows
  if (input_scale > 0.0) certificate.complementarity = input_ / input_scale;
  if (slack_scale_ > 0.0) certificate.complementarity = std::max(certificate.complementarity, slack_ / slack_scale_);
  certificate.kcl_kvl = largest_residual(rows_);
  if (energy_scale_ > 0.0) certificate.energy = energy_ / energy_scale_;
  certificate.energy = std::max(certificate.energy, estimate_);
  return certificate;
}

}  // namespace pwlsim::engine::sparse
