#include "circuit/function_derivatives.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace pwlsim::circuit {
namespace {

using ArgumentValues = std::span<const double>;

struct Derivative {
  std::string_view name;
  double (*value)(double x);
};

double square(double x) { return x * x; }

constexpr Derivative derivatives_of_one[] = {
    {"sqrt", [](double x) { return 0.5 / std::sqrt(x); }},
    {"exp", [](double x) { return std::exp(x); }},
    {"ln", [](double x) { return 1.0 / x; }},
    {"log", [](double x) { return 1.0 / x; }},
    {"log10", [](double x) { return 1.0 / (x * std::numbers::ln10); }},
    {"sin", [](double x) { return std::cos(x); }},
    {"cos", [](double x) { return -std::sin(x); }},
    {"tan", [](double x) { return 1.0 / square(std::cos(x)); }},
    {"asin", [](double x) { return 1.0 / std::sqrt(1.0 - x * x); }},
    {"acos", [](double x) { return -1.0 / std::sqrt(1.0 - x * x); }},
    {"atan", [](double x) { return 1.0 / (1.0 + x * x); }},
    {"arcsin", [](double x) { return 1.0 / std::sqrt(1.0 - x * x); }},
    {"arccos", [](double x) { return -1.0 / std::sqrt(1.0 - x * x); }},
    {"arctan", [](double x) { return 1.0 / (1.0 + x * x); }},
    {"sinh", [](double x) { return std::cosh(x); }},
    {"cosh", [](double x) { return std::sinh(x); }},
    {"tanh", [](double x) { return 1.0 / square(std::cosh(x)); }},
    {"asinh", [](double x) { return 1.0 / std::sqrt(1.0 + x * x); }},
    {"acosh", [](double x) { return 1.0 / std::sqrt(x * x - 1.0); }},
    {"atanh", [](double x) { return 1.0 / (1.0 - x * x); }},
};

Partials power_partials(double a, double b) {
  Partials p;
  if (b != 0.0) p.left = b * std::pow(a, b - 1.0);
  if (a > 0.0) p.right = std::pow(a, b) * std::log(a);
  return p;
}

void of_several(std::string_view name, ArgumentValues a, std::span<double> out, bool& has_kink) {
  if (name == "abs") {
    out[0] = sign(a[0]);
    has_kink |= a[0] == 0.0;
  } else if (name == "atan2") {
    const double r = a[0] * a[0] + a[1] * a[1];
    out[0] = a[1] / r;
    out[1] = -a[0] / r;
  } else if (name == "hypot") {
    const double r = std::hypot(a[0], a[1]);
    out[0] = a[0] / r;
    out[1] = a[1] / r;
  } else if (name == "pow") {
    const Partials p = power_partials(a[0], a[1]);
    out[0] = p.left;
    out[1] = p.right;
  } else if (name == "pwr" || name == "pwrs") {
    const Partials p = power_partials(std::fabs(a[0]), a[1]);
    out[0] = name == "pwr" ? p.left * sign(a[0]) : p.left;
    out[1] = name == "pwr" ? p.right : p.right * sign(a[0]);
  } else if (name == "mod") {
    out[0] = 1.0;
    out[1] = -std::floor(a[0] / a[1]);
  } else if (name == "min" || name == "max" || name == "limit") {
    std::vector<double> sorted(a.begin(), a.end());
    std::sort(sorted.begin(), sorted.end());
    const double taken = name == "min" ? sorted.front() : name == "max" ? sorted.back() : sorted[1];
    const auto at = static_cast<std::size_t>(std::find(a.begin(), a.end(), taken) - a.begin());
    out[at] = 1.0;
    has_kink |= std::count(a.begin(), a.end(), taken) > 1;
  }
}

}  // namespace

void function_partials(const BuiltinFunction& function, ArgumentValues arguments, std::span<double> partials, bool& has_kink) {
  std::fill(partials.begin(), partials.end(), 0.0);
  const auto* known = std::find_if(std::begin(derivatives_of_one), std::end(derivatives_of_one),
                                   [&](const Derivative& d) { return d.name == function.name; });
  if (known != std::end(derivatives_of_one))
    partials[0] = known->value(arguments[0]);
  else
    of_several(function.name, arguments, partials, has_kink);
}

Partials operation_partials(std::string_view op, double left, double right) {
  if (op == "+") return {1.0, 1.0};
  if (op == "-") return {1.0, -1.0};
  if (op == "*") return {right, left};
  if (op == "/") return {1.0 / right, -left / (right * right)};
  if (op == "^" || op == "**") return power_partials(left, right);
  return {};
}

}  // namespace pwlsim::circuit
