#include "circuit/polynomial.hpp"

#include <algorithm>
#include <utility>

#include "circuit/made_expressions.hpp"

namespace pwlsim::circuit {

bool Polynomial::take(double coefficient, SourceSpan span) {
  const bool is_linear = linear_.size() <= controls_.size();
  if (is_linear) {
    linear_.push_back(coefficient);
  } else if (coefficient != 0.0) {
    if (std::adjacent_find(factors_.begin(), factors_.end()) != factors_.end()) return false;
    netlist::Expression product = term(coefficient, factors_, span);
    products_ = products_ ? make::operation(std::move(*products_), "+", std::move(product), span) : std::move(product);
  }
  go_to_next_term();
  return true;
}

void Polynomial::go_to_next_term() {
  std::size_t k = factors_.size();
  while (k > 0 && factors_[k - 1] + 1 == controls_.size()) --k;
  if (k == 0) return factors_.assign(factors_.size() + 1, 0);
  const std::size_t least = factors_[k - 1] + 1;
  std::fill(factors_.begin() + static_cast<std::ptrdiff_t>(k) - 1, factors_.end(), least);
}

netlist::Expression Polynomial::term(double coefficient, const std::vector<std::size_t>& factors, SourceSpan span) const {
  netlist::Expression product = make::number(coefficient, span);
  for (const std::size_t factor : factors) product = make::operation(std::move(product), "*", controls_[factor], span);
  return product;
}

netlist::Expression Polynomial::expression() const {
  netlist::Expression sum = *products_;
  const SourceSpan span = sum.span;
  for (std::size_t k = 0; k < linear_.size(); ++k)
    if (linear_[k] != 0.0)
      sum = make::operation(std::move(sum), "+", term(linear_[k], k == 0 ? std::vector<std::size_t>{} : std::vector{k - 1}, span), span);
  return sum;
}

}  // namespace pwlsim::circuit
