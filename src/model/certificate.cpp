#include "model/certificate.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::model {

double kyp_residual(const System& system) {
  const int n = system.n;
  const int k = system.ports;
  const Matrix a = system.time_scale * system.a.topLeftCorner(n, n);
  const Matrix b = system.time_scale * system.b.topRows(n);
  const Matrix c = system.c.leftCols(n);
  Matrix kyp(n + k, n + k);
  kyp.topLeftCorner(n, n) = a + a.transpose();
  kyp.topRightCorner(n, k) = b - c.transpose();
  kyp.bottomLeftCorner(k, n) = b.transpose() - c;
  kyp.bottomRightCorner(k, k) = -(system.d + system.d.transpose());
  const double rate = linalg::spectral_norm(a);
  if (rate > 0.0) {
    kyp.topRows(n) /= std::sqrt(rate);
    kyp.leftCols(n) /= std::sqrt(rate);
  }
  return linalg::logarithmic_norm(kyp);
}

bool has_passive_parts_only(const Network& network) {
  const auto independent = [](const Term& term) { return term.kind == Term::Kind::one || term.kind == Term::Kind::source; };
  const auto is_source = [&](const Injection& injection) { return std::all_of(injection.current.begin(), injection.current.end(), independent); };
  const auto no_gain = [](const auto& element) { return element.resistance >= 0.0; };
  const auto branch_has_no_gain = [&](std::size_t index) {
    return std::all_of(network.branches[index].voltage.begin(), network.branches[index].voltage.end(), [&](const Term& term) {
      const bool own_resistance = term.kind == Term::Kind::branch_current && term.index == static_cast<int>(index) && term.coefficient <= 0.0;
      return independent(term) || own_resistance;
    });
  };
  for (std::size_t i = 0; i < network.branches.size(); ++i)
    if (!branch_has_no_gain(i)) return false;
  if (!network.complementarities.empty()) return false;
  return std::all_of(network.injections.begin(), network.injections.end(), is_source) &&
         std::all_of(network.resistors.begin(), network.resistors.end(), no_gain) &&
         std::all_of(network.diodes.begin(), network.diodes.end(), no_gain) &&
         std::all_of(network.switches.begin(), network.switches.end(), no_gain);
}

}  // namespace pwlsim::model
