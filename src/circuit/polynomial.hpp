#pragma once
/// POLY(n) of E, F, G and H: its coefficients in the order of SPICE2, 1, x1 … xn, x1², x1·x2 … x1·xn, x2² …, x1³ …

#include <cstddef>
#include <optional>
#include <vector>

#include "netlist/ast.hpp"

namespace pwlsim::circuit {

class Polynomial {
 public:
  /// A polynomial of these controls, one or more.
  explicit Polynomial(std::vector<netlist::Expression> controls) : controls_(std::move(controls)) {}

  /// The next coefficient. False: it is not zero, and that of a term with a power.
  bool take(double coefficient, SourceSpan span);
  /// p0 … pn, as many as were given.
  [[nodiscard]] const std::vector<double>& linear() const { return linear_; }
  /// A term with two controls or more has a coefficient.
  [[nodiscard]] bool has_products() const { return products_.has_value(); }
  /// The whole of a polynomial with products.
  [[nodiscard]] netlist::Expression expression() const;

 private:
  [[nodiscard]] netlist::Expression term(double coefficient, const std::vector<std::size_t>& factors, SourceSpan span) const;
  void go_to_next_term();

  std::vector<netlist::Expression> controls_;
  std::vector<std::size_t> factors_;  ///< controls of the present term, ascending; none at first
  std::vector<double> linear_;
  std::optional<netlist::Expression> products_;  ///< a sum
};

}  // namespace pwlsim::circuit
