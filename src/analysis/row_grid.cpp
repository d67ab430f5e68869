#include "analysis/row_grid.hpp"

#include <limits>

#include "base/decimal.hpp"

namespace pwlsim::analysis {
namespace {

constexpr int steps_when_omitted_exponent = 3;  // 10^3 steps

Decimal exact(const circuit::TimeValue& value) {
  const auto parsed = parse_decimal(value.decimal);
  return parsed ? *parsed : decimal_from_double(value.seconds);
}

Decimal step_of(const circuit::TransientAnalysis& transient, const Decimal& start, const Decimal& stop) {
  if (transient.step.seconds != 0.0) return exact(transient.step);
  Decimal span = difference(stop, start).value_or(decimal_from_double(transient.stop.seconds - transient.start.seconds));
  span.exponent -= steps_when_omitted_exponent;
  return span;
}

}  // namespace

engine::RowGrid row_grid(const circuit::TransientAnalysis& transient) {
  const Decimal start = exact(transient.start);
  const Decimal stop = exact(transient.stop);
  const Decimal step = step_of(transient, start, stop);
  const double last = transient.stop.seconds;

  const std::int64_t steps = steps_between(start, stop, step);
  const bool rounded = transient.step.seconds != 0.0 && transient.step.decimal.empty();
  const double slack = rounded ? last * std::numeric_limits<double>::epsilon() : 0.0;
  const bool ends_at_stop = steps > 0 && affine(start, steps, step) >= last - slack;
  const auto rows = static_cast<std::uint64_t>(steps) + (ends_at_stop ? 1 : 2);
  const auto time = [start, step, last, rows](std::uint64_t k) {
    return k + 1 >= rows ? last : affine(start, static_cast<std::int64_t>(k), step);
  };
  return {time, rows};
}

}  // namespace pwlsim::analysis
