#include "engine/sparse/tie_selector.hpp"
#include "engine/sparse/tolerances.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::engine::sparse {

void TieSelector::find(const std::vector<double>& z, const std::vector<double>& w, const Position& on, int passing) {
  const auto ports = static_cast<std::size_t>(descriptor_.first_switch());
  const double voltage = std::max(least_, solver_.largest_voltage(z));
  double input = least_;
  for (const DescriptorPort& port : descriptor_.ports()) input = std::max(input, std::abs(z[static_cast<std::size_t>(port.row)]));
  at_zero_.assign(ports, 0);
  for (std::size_t i = 0; i < ports; ++i) {
    const DescriptorPort& port = descriptor_.ports()[i];
    const double slack = std::abs(port.slack.value(z.data(), w.data()));
    const bool is_zero =
        std::abs(z[static_cast<std::size_t>(port.row)]) <= std::max(tolerance::tied_port * input, tolerance::sum_rounding * input_terms_) &&
        slack <= tolerance::tied_port * std::max(voltage, port.slack_size(z.data(), w.data()));
    at_zero_[i] = !port.blocks(on) && (is_zero || static_cast<int>(i) == passing);
  }
}

bool TieSelector::decide(const std::vector<double>& z, const std::vector<double>& zeta, double h, Position& on) {
  change_.take(z, {}, Eigen::Map<const linalg::Vector>(zeta.data(), static_cast<Eigen::Index>(zeta.size())), 1.0 / h);
  right_ = change_.right();
  zero_.assign(z.size(), 0.0);
  return solver_.solve({1.0 / h, zero_, right_, none_, &at_zero_}, on, step_, z_) == Solved::yes;
}

}  // namespace pwlsim::engine::sparse
