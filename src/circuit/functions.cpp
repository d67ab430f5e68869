#include "circuit/functions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/names.hpp"

namespace pwlsim::circuit {
namespace {

using ArgumentValues = std::span<const double>;

constexpr std::size_t any_number = std::numeric_limits<std::size_t>::max();

template <double (*F)(double)>
double of_one(ArgumentValues a) {
  return F(a[0]);
}
template <double (*F)(double, double)>
double of_two(ArgumentValues a) {
  return F(a[0], a[1]);
}

double median(ArgumentValues a) { return std::max(std::min(a[0], a[1]), std::min(std::max(a[0], a[1]), a[2])); }

constexpr BuiltinFunction functions[] = {
    {"sqrt", 1, 1, of_one<std::sqrt>},
    {"exp", 1, 1, of_one<std::exp>},
    {"ln", 1, 1, of_one<std::log>},
    {"log", 1, 1, of_one<std::log>},
    {"log10", 1, 1, of_one<std::log10>},
    {"sin", 1, 1, of_one<std::sin>},
    {"cos", 1, 1, of_one<std::cos>},
    {"tan", 1, 1, of_one<std::tan>},
    {"asin", 1, 1, of_one<std::asin>},
    {"acos", 1, 1, of_one<std::acos>},
    {"atan", 1, 1, of_one<std::atan>},
    {"arcsin", 1, 1, of_one<std::asin>},
    {"arccos", 1, 1, of_one<std::acos>},
    {"arctan", 1, 1, of_one<std::atan>},
    {"atan2", 2, 2, of_two<std::atan2>, false, Corners::at_zero},
    {"hypot", 2, 2, of_two<std::hypot>},
    {"sinh", 1, 1, of_one<std::sinh>},
    {"cosh", 1, 1, of_one<std::cosh>},
    {"tanh", 1, 1, of_one<std::tanh>},
    {"asinh", 1, 1, of_one<std::asinh>},
    {"acosh", 1, 1, of_one<std::acosh>},
    {"atanh", 1, 1, of_one<std::atanh>},
    {"abs", 1, 1, of_one<std::fabs>, false, Corners::at_zero},
    {"pow", 2, 2, of_two<std::pow>},
    {"pwr", 2, 2, [](ArgumentValues a) { return std::pow(std::fabs(a[0]), a[1]); }, false, Corners::at_zero},
    {"pwrs", 2, 2, [](ArgumentValues a) { return sign(a[0]) * std::pow(std::fabs(a[0]), a[1]); }, false, Corners::at_zero},
    {"floor", 1, 1, of_one<std::floor>, false, Corners::at_integers},
    {"ceil", 1, 1, of_one<std::ceil>, false, Corners::at_integers},
    {"int", 1, 1, of_one<std::trunc>, false, Corners::at_integers},
    {"round", 1, 1, of_one<std::round>, false, Corners::at_halves},
    {"mod", 2, 2, [](ArgumentValues a) { return a[0] - a[1] * std::floor(a[0] / a[1]); }, false, Corners::of_quotient},
    {"buf", 1, 1, [](ArgumentValues a) { return a[0] > 0.5 ? 1.0 : 0.0; }, false, Corners::at_half},
    {"inv", 1, 1, [](ArgumentValues a) { return a[0] > 0.5 ? 0.0 : 1.0; }, false, Corners::at_half},
    {"sgn", 1, 1, of_one<sign>, false, Corners::at_zero},
    {"limit", 3, 3, median, true, Corners::of_differences},
    {"min", 2, any_number, [](ArgumentValues a) { return *std::min_element(a.begin(), a.end()); }, true, Corners::of_differences},
    {"max", 2, any_number, [](ArgumentValues a) { return *std::max_element(a.begin(), a.end()); }, true, Corners::of_differences},
};

struct SpelledOperator {
  std::string_view text;
  BinaryOperator value;
};

double power(double a, double b) { return std::pow(a, b); }
double both(double a, double b) { return a != 0.0 && b != 0.0; }
double either(double a, double b) { return a != 0.0 || b != 0.0; }

constexpr SpelledOperator operators[] = {
    {"+", [](double a, double b) { return a + b; }},
    {"-", [](double a, double b) { return a - b; }},
    {"*", [](double a, double b) { return a * b; }},
    {"/", [](double a, double b) { return a / b; }},
    {"^", power},
    {"**", power},
    {"<", [](double a, double b) -> double { return a < b; }},
    {">", [](double a, double b) -> double { return a > b; }},
    {"<=", [](double a, double b) -> double { return a <= b; }},
    {">=", [](double a, double b) -> double { return a >= b; }},
    {"==", [](double a, double b) -> double { return a == b; }},
    {"!=", [](double a, double b) -> double { return a != b; }},
    {"&", both},
    {"&&", both},
    {"|", either},
    {"||", either},
};

}  // namespace

std::span<const BuiltinFunction> builtin_functions() { return functions; }

const BuiltinFunction* find_builtin(std::string_view name) {
  const auto* found = std::find_if(std::begin(functions), std::end(functions), [&](const auto& f) { return same_name(f.name, name); });
  return found == std::end(functions) ? nullptr : found;
}

bool compares(std::string_view op) { return op == "<" || op == ">" || op == "<=" || op == ">=" || op == "==" || op == "!="; }

BinaryOperator find_binary(std::string_view op) {
  const auto* found = std::find_if(std::begin(operators), std::end(operators), [&](const auto& o) { return o.text == op; });
  if (found != std::end(operators)) return found->value;
  return [](double, double) { return std::numeric_limits<double>::quiet_NaN(); };
}

}  // namespace pwlsim::circuit
