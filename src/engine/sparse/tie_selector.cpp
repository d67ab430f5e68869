#include "engine/sparse/tie_selector.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::engine::sparse {

namespace {

constexpr double at_zero = 1e-10;  ///< of the largest input, and of a slack's terms

}  // namespace

bool TieSelector::find(const std::vector<double>& z, const std::vector<double>& w, const Position& on, int passing) {
  const auto ports = static_cast<std::size_t>(descriptor_.first_switch());
  const double voltage = std::max(least_, solver_.largest_voltage(z));
  double input = least_;
  for (const Port& port : descriptor_.ports()) input = std::max(input, std::abs(z[static_cast<std::size_t>(port.row)]));
  disputed_.assign(ports, 0);
  for (std::size_t i = 0; i < ports; ++i) {
    const Port& port = descriptor_.ports()[i];
    const double slack = std::abs(port.slack.value(z.data(), w.data()));
    const bool is_zero = std::abs(z[static_cast<std::size_t>(port.row)]) <= at_zero * input &&
                         slack <= at_zero * std::max(voltage, port.slack_size(z.data(), w.data()));
    disputed_[i] = !port.blocks(on) && (is_zero || static_cast<int>(i) == passing);
  }
  return std::find(disputed_.begin(), disputed_.end(), 1) != disputed_.end();
}

bool TieSelector::decide(const std::vector<double>& z, const std::vector<double>& zeta, double h, Position& on) {
  change_.take(z, {}, Eigen::Map<const linalg::Vector>(zeta.data(), static_cast<Eigen::Index>(zeta.size())), 1.0 / h);
  zero_.assign(z.size(), 0.0);
  return solver_.solve({1.0 / h, zero_, change_.right(), none_, &disputed_}, on, step_, z_) == Solved::yes;
}

}  // namespace pwlsim::engine::sparse
