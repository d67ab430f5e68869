#include "base/decimal.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using pwlsim::affine;
using pwlsim::compare_affine;
using pwlsim::Decimal;
using pwlsim::decimal_from_double;
using pwlsim::difference;
using pwlsim::parse_decimal;
using pwlsim::steps_between;
using pwlsim::to_double;

namespace {

Decimal dec(const char* text) {
  const auto value = parse_decimal(text);
  REQUIRE(value.has_value());
  return *value;
}

}  // namespace

TEST_CASE("decimal text is read exactly", "[unit]") {
  struct Row {
    const char* text;
    std::int64_t mantissa;
    int exponent;
  };
  const auto row = GENERATE(Row{"0", 0, 0}, Row{"-0.0e5", 0, 0}, Row{"1", 1, 0}, Row{"+12.50", 125, -1}, Row{"-.5e-6", -5, -7},
                            Row{"5.", 5, 0}, Row{"1e3", 1, 3}, Row{"1e+03", 1, 3}, Row{"1200", 12, 2}, Row{"0.00012", 12, -5},
                            Row{"9223372036854775807", std::numeric_limits<std::int64_t>::max(), 0});
  CAPTURE(row.text);
  const Decimal value = dec(row.text);
  CHECK(value.mantissa == row.mantissa);
  CHECK(value.exponent == row.exponent);
}

TEST_CASE("what is not decimal text, or too long or too far out, is nothing", "[unit]") {
  const auto* text = GENERATE("", "-", ".", "e5", "1e", "1e+", "1e+-3", "1.2.3", "1k", " 1", "1 ", "inf", "nan", "0x10", "--1",
                              "9223372036854775808", "1e999", "1e-999", "1e99999999999999999999");
  CAPTURE(text);
  CHECK_FALSE(parse_decimal(text).has_value());
}

TEST_CASE("a double becomes its shortest decimal", "[unit]") {
  CHECK(decimal_from_double(0.1).mantissa == 1);
  CHECK(decimal_from_double(0.1).exponent == -1);
  CHECK(decimal_from_double(-2.5e-9).mantissa == -25);
  CHECK(decimal_from_double(0.0).mantissa == 0);
  const auto value = GENERATE(1.0 / 3.0, 1e-7, 5e-324, std::numeric_limits<double>::max(), -123456.789, 2e-6);
  CHECK(to_double(decimal_from_double(value)) == value);
}

TEST_CASE("rows stand where their decimal text says", "[unit]") {
  // Each expected literal is the decimal sum done by hand; the compiler rounds it correctly.
  struct Row {
    const char* start;
    std::int64_t k;
    const char* step;
    double expected;
  };
  const auto row =
      GENERATE(Row{"0", 3, "0.1", 0.3}, Row{"0", 7, "0.1", 0.7}, Row{"0", 1000000000, "1e-9", 1.0},
               Row{"0", 999999999, "1e-9", 0.999999999}, Row{"1e-3", 3, "1e-4", 1.3e-3}, Row{"0.05", 123, "2.5e-7", 0.05003075},
               Row{"0", -3, "0.1", -0.3}, Row{"1", 1, "-1", 0.0}, Row{"1e300", 1, "1e-300", 1e300}, Row{"1", 1, "1e-16", 1.0},
               // 2^53 + 1 is a tie and goes to even, but any bit below it, however small, rounds up.
               Row{"9007199254740993", 0, "1", 9007199254740992.0}, Row{"9007199254740993", 1, "1e-50", 9007199254740994.0},
               Row{"-9007199254740993", 1, "-1e-50", -9007199254740994.0},
               Row{"4611686018427387904", 1, "4611686018427387904", 9223372036854775808.0}, Row{"1e200", 1, "-1e200", 0.0},
               Row{"1", 1, "1e-12", 1.000000000001}, Row{"1000000", 1, "1e-12", 1000000.000000000001});
  CAPTURE(row.start, row.k, row.step);
  CHECK(affine(dec(row.start), row.k, dec(row.step)) == row.expected);
}

TEST_CASE("a huge exponent rounds to zero or infinity", "[unit]") {
  CHECK(to_double(Decimal{1, 399}) == std::numeric_limits<double>::infinity());
  CHECK(to_double(Decimal{-1, -399}) == 0.0);
  CHECK(to_double(Decimal{-1, 399}) == -std::numeric_limits<double>::infinity());
}

TEST_CASE("comparison with the grid is exact", "[unit]") {
  CHECK(compare_affine(dec("0"), 3, dec("0.1"), dec("0.3")) == 0);
  CHECK(compare_affine(dec("0"), 3, dec("0.1"), dec("0.30000000000000001")) == -1);
  CHECK(compare_affine(dec("0"), 3, dec("0.1"), dec("0.29999999999999999")) == 1);
  CHECK(compare_affine(dec("1e300"), 1, dec("1e-300"), dec("1e300")) == 1);
  CHECK(compare_affine(dec("-1e300"), 1, dec("-1e-300"), dec("-1e300")) == -1);
}

TEST_CASE("steps between two times are counted exactly", "[unit]") {
  struct Row {
    const char* start;
    const char* stop;
    const char* step;
    std::int64_t expected;
  };
  const auto row = GENERATE(Row{"0", "0.3", "0.1", 3}, Row{"0", "0.29999999", "0.1", 2}, Row{"0", "1", "3e-1", 3}, Row{"0", "0", "1", 0},
                            Row{"0.1", "0.7", "0.1", 6}, Row{"0", "1", "1e-9", 1000000000}, Row{"5", "5.9", "1", 0},
                            Row{"0", "1e300", "1e-300", std::int64_t{1} << 62}, Row{"-1", "1", "1e-3", 2000});
  CAPTURE(row.start, row.stop, row.step);
  CHECK(steps_between(dec(row.start), dec(row.stop), dec(row.step)) == row.expected);
}

TEST_CASE("differences are exact or absent", "[unit]") {
  const auto value = difference(dec("0.3"), dec("1e-3"));
  REQUIRE(value.has_value());
  CHECK(value->mantissa == 299);
  CHECK(value->exponent == -3);
  CHECK(difference(dec("1"), dec("3"))->mantissa == -2);
  CHECK(difference(dec("7.5"), dec("7.5"))->mantissa == 0);
  CHECK_FALSE(difference(dec("1e200"), dec("1")).has_value());
}
