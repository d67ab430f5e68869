#include "engine/sparse/tie_selector.hpp"
#include "engine/sparse/tolerances.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::engine::sparse {

namespace {

constexpr int most_orders = 4;

}  // namespace

bool TieSelector::find(const std::vector<double>& z, const std::vector<double>& w, const Position& on, int passing) {
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
  return std::find(at_zero_.begin(), at_zero_.end(), 1) != at_zero_.end();
}

/// Of the ports in dispute those that the change `step_` leaves at zero on both sides, the wrong side of it by rounding included. False: none.
bool TieSelector::keep_undecided(const Position& on) {
  double input = 0.0;
  for (const DescriptorPort& port : descriptor_.ports()) input = std::max(input, std::abs(step_[static_cast<std::size_t>(port.row)]));
  bool any = false;
  for (std::size_t i = 0; i < disputed_.size(); ++i) {
    if (disputed_[i] == 0) continue;
    const DescriptorPort& port = descriptor_.ports()[i];
    const double size = on[i] != 0 ? input : Form::size_of(port.slack.z, step_.data());
    disputed_[i] = port.response(on[i] != 0, step_.data()) <= tolerance::undecided_change * size;
    any |= disputed_[i] != 0;
  }
  return any;
}

/// The right-hand side of the change of `step_` in the next order, and ζ_ of that order.
void TieSelector::take_next_order(double h) {
  right_.resize(step_.size());
  descriptor_.conduct(step_.data(), right_.data());
  const linalg::Vector w = exosystem_.values(zeta_);
  descriptor_.add_sources(w.data(), right_.data());
  for (std::size_t i = 0; i < right_.size(); ++i)
    if (differential_[i] == 0) right_[i] = 0.0;
  zeta_ = after_step(exosystem_, h, h * exosystem_.rates(zeta_));
  const linalg::Vector change = exosystem_.values(zeta_);
  descriptor_.add_sources(change.data(), right_.data());
}

bool TieSelector::decide(const std::vector<double>& z, const std::vector<double>& zeta, double h, Position& on) {
  const linalg::Vector start = Eigen::Map<const linalg::Vector>(zeta.data(), static_cast<Eigen::Index>(zeta.size()));
  change_.take(z, {}, start, 1.0 / h);
  right_ = change_.right();
  zeta_ = after_step(exosystem_, h, h * exosystem_.rates(start));
  zero_.assign(z.size(), 0.0);
  disputed_ = at_zero_;
  for (int order = 1; order <= most_orders; ++order) {
    const Position before = on;
    if (solver_.solve({1.0 / h, zero_, right_, none_, &disputed_}, on, step_, z_) != Solved::yes) {
      on = before;
      return order > 1;
    }
    if (!keep_undecided(on)) return true;
    take_next_order(h);
  }
  return true;
}

}  // namespace pwlsim::engine::sparse
