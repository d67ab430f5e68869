#include "netlist/number.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <string>

#include "base/decimal.hpp"

using pwlsim::netlist::read_number;

TEST_CASE("numbers with suffixes and units are correctly rounded", "[unit]") {
  // The expected literals are the meaning language.md gives, rounded by the compiler.
  struct Row {
    const char* text;
    double value;
  };
  const auto row =
      GENERATE(Row{"0", 0.0}, Row{"10", 10.0}, Row{"+5", 5.0}, Row{"-15", -15.0}, Row{"1.", 1.0}, Row{".5", 0.5}, Row{"-.5e-6", -0.5e-6},
               Row{"1e-3", 1e-3}, Row{"1E+3", 1e3}, Row{"1e3k", 1e6},
               // every suffix, in any case
               Row{"1T", 1e12}, Row{"1t", 1e12}, Row{"1G", 1e9}, Row{"1g", 1e9}, Row{"1Meg", 1e6}, Row{"1MEG", 1e6}, Row{"1meg", 1e6},
               Row{"1K", 1e3}, Row{"1k", 1e3}, Row{"1Mil", 25.4e-6}, Row{"1mil", 25.4e-6}, Row{"2.5MIL", 63.5e-6}, Row{"1M", 1e-3},
               Row{"1m", 1e-3}, Row{"1u", 1e-6}, Row{"1U", 1e-6}, Row{"1\u00B5", 1e-6}, Row{"1\u03BC", 1e-6}, Row{"1n", 1e-9},
               Row{"1N", 1e-9}, Row{"1p", 1e-12}, Row{"1P", 1e-12}, Row{"1f", 1e-15}, Row{"1F", 1e-15},
               // then any letters
               Row{"10kOhm", 10e3}, Row{"1uF", 1e-6}, Row{"1\u00B5F", 1e-6}, Row{"5A", 5.0}, Row{"3V", 3.0}, Row{"2s", 2.0},
               Row{"50Hz", 50.0}, Row{"1MOhm", 1e-3}, Row{"1MegOhm", 1e6}, Row{"10\u03A9", 10.0}, Row{"4.7k\u2126", 4.7e3}, Row{"5eV", 5.0},
               Row{"1ms", 1e-3}, Row{"1milli", 25.4e-6},
               // a suffix in place of the point
               Row{"1k5", 1500.0}, Row{"4R7", 4.7}, Row{"4r7", 4.7}, Row{"2u2", 2.2e-6}, Row{"-2u2", -2.2e-6}, Row{"1Meg5", 1.5e6},
               Row{"0R05", 0.05}, Row{"2\u00B52F", 2.2e-6}, Row{"1n05", 1.05e-9}, Row{"4k7Ohm", 4700.0},
               // where a product in doubles would miss the nearest double
               Row{"0.1u", 1e-7}, Row{"0.3m", 3e-4}, Row{"4.7n", 4.7e-9}, Row{"2.2u", 2.2e-6}, Row{"0.7k", 700.0}, Row{"330p", 330e-12},
               Row{"123456789012345678901234567890n", 123456789012345678901234567890e-9},
               Row{"0.000000000000000000000000000000000000000000001T", 1e-33}, Row{"9007199254740993", 9007199254740992.0},
               Row{"9007199254740993.00000000000000000001", 9007199254740994.0});
  CAPTURE(row.text);
  const auto number = read_number(row.text);
  CHECK(number.valid);
  CHECK_FALSE(number.infinite);
  CHECK(number.value == row.value);
}

TEST_CASE("what is not a number is not read as one", "[unit]") {
  const std::string text =
      GENERATE("", "+", "-", ".", "-.", "k", "F", "1k5.2", "1.5k5", "1e3k5", "5A3", "1_000", "0x10", "1,5", "1+2", "--1", "+-1", "1-",
               "1e+", "abc", "R1", "1/2", "10%", "1 k", " 1", "infinity", "nan", "1:2", "$1", "1$");
  CAPTURE(text);
  CHECK_FALSE(read_number(text).valid);
}

TEST_CASE("inf is a written limit, overflow is not", "[unit]") {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const char* text : {"inf", "INF", "+inf"}) {
    CHECK(read_number(text).valid);
    CHECK(read_number(text).infinite);
    CHECK(read_number(text).value == infinity);
  }
  CHECK(read_number("-inf").value == -infinity);
  CHECK(read_number("1e400").valid);
  CHECK_FALSE(read_number("1e400").infinite);
  CHECK(read_number("1e400").value == infinity);
  CHECK(read_number("1e-400").value == 0.0);
  CHECK(read_number("1e99999999999999999999").value == infinity);
  CHECK(read_number("0e99999999999999999999").value == 0.0);
}

TEST_CASE("a lone F is flagged as femto", "[unit]") {
  struct Row {
    const char* text;
    bool bare;
  };
  const auto row = GENERATE(Row{"1F", true}, Row{"100f", true}, Row{"1Farad", true}, Row{"1fF", false}, Row{"1uF", false},
                            Row{"1F5", false}, Row{"1", false}, Row{"1pF", false});
  CAPTURE(row.text);
  CHECK(read_number(row.text).bare_femto == row.bare);
}

TEST_CASE("the decimal text is the number itself", "[unit]") {
  struct Row {
    const char* text;
    std::int64_t mantissa;
    int exponent;
  };
  const auto row = GENERATE(Row{"0.1u", 1, -7}, Row{"-12.5u", -125, -7}, Row{"1mil", 254, -7}, Row{"2u2", 22, -7}, Row{"10k", 1, 4},
                            Row{"0", 0, 0}, Row{"1e-3s", 1, -3});
  CAPTURE(row.text);
  const auto decimal = pwlsim::parse_decimal(read_number(row.text).decimal_digits);
  REQUIRE(decimal.has_value());
  CHECK(decimal->mantissa == row.mantissa);
  CHECK(decimal->exponent == row.exponent);
}

TEST_CASE("decimal text too long for its field is left empty", "[unit]") {
  CHECK(std::string(read_number(std::string(60, '1')).decimal_digits).empty());
  CHECK(std::string(read_number("1" + std::string(36, '2')).decimal_digits) == "1" + std::string(36, '2') + "e0");
}
