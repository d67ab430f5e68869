#include "engine/sparse/certificate.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::engine::sparse {

namespace {

constexpr std::uint64_t points_per_stride = 64;
/// A row whose terms never exceed this fraction of the largest is judged against that fraction.
constexpr double idle_row = 1e-3;

double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

void CertificateRecorder::add(const Point& from, const Stepper::Trial& trial, double h, const PortSolver& ports) {
  if (seen_++ % stride_ != 0) return;
  if (++points_ % points_per_stride == 0) stride_ *= 2;
  add_rows(trial.end);
  add_ports(trial.end, ports);
  add_energy(from, trial, h);
}

void CertificateRecorder::add_rows(const Point& point) {
  const auto n = static_cast<std::size_t>(descriptor_.size());
  for (auto* v : {&residual_, &size_}) v->resize(n, 0.0);
  for (auto* v : {&row_, &row_size_}) v->resize(n);
  descriptor_.matrix(0.0, point.on, 0.0, 1.0, values_);
  linalg::multiply(descriptor_.pattern(), values_, point.z.data(), row_.data());
  linalg::multiply_absolute(descriptor_.pattern(), values_, point.z.data(), row_size_.data());
  std::vector<double> input(n);
  descriptor_.input(point.w.data(), point.on, input.data());
  const std::size_t equations = n - descriptor_.ports().size();  // closing rows come last, and are the diodes' own
  for (int node = 0; node < descriptor_.nodes(); ++node) voltage_ = std::max(voltage_, std::abs(point.z[static_cast<std::size_t>(node)]));
  for (std::size_t i = 0; i < n; ++i) {
    if (i < equations) residual_[i] = std::max(residual_[i], std::abs(point.k[i] + row_[i] - input[i]));
    size_[i] = std::max(size_[i], std::abs(point.k[i]) + row_size_[i] + std::abs(input[i]));
  }
}

void CertificateRecorder::add_ports(const Point& point, const PortSolver& ports) {
  for (int i = 0; i < descriptor_.first_switch(); ++i) {
    const Port& port = descriptor_.ports()[static_cast<std::size_t>(i)];
    const double u = point.z[static_cast<std::size_t>(port.row)];
    const double s = port.slack.value(point.z.data(), point.w.data());
    const bool on = point.on[static_cast<std::size_t>(i)] != 0;
    input_ = std::max(input_, on ? -u : std::abs(u));
    slack_ = std::max(slack_, on ? std::abs(s) : -s);
    input_scale_ = std::max({input_scale_, std::abs(u), ports.scale().input});
    slack_scale_ = std::max({slack_scale_, std::abs(s), ports.scale().slack});
  }
}

void CertificateRecorder::add_energy(const Point& from, const Stepper::Trial& trial, double h) {
  const double before = 0.5 * product(from.z, from.y), after = 0.5 * product(trial.end.z, trial.end.y);
  const double first = h * (1.0 - gamma_sdirk) * product(trial.stage, trial.stage_k);
  const double second = h * gamma_sdirk * product(trial.end.z, trial.end.k);
  energy_ = std::max(energy_, std::abs(after - before - first - second));
  energy_scale_ = std::max({energy_scale_, std::abs(before), std::abs(after), std::abs(first) + std::abs(second)});
}

Certificate CertificateRecorder::check() const {
  Certificate certificate;
  certificate.points_checked = points_;
  const double input_scale = std::max(input_scale_, idle_row * slack_scale_);  // where no current ever flows
  if (input_scale > 0.0) certificate.complementarity = input_ / input_scale;
  if (slack_scale_ > 0.0) certificate.complementarity = std::max(certificate.complementarity, slack_ / slack_scale_);
  const double largest = size_.empty() ? 0.0 : std::max(voltage_, *std::max_element(size_.begin(), size_.end()));
  for (std::size_t i = 0; i < size_.size(); ++i)
    if (size_[i] > 0.0) certificate.kcl_kvl = std::max(certificate.kcl_kvl, residual_[i] / std::max(size_[i], idle_row * largest));
  if (energy_scale_ > 0.0) certificate.energy = energy_ / energy_scale_;
  return certificate;
}

}  // namespace pwlsim::engine::sparse
