#include "waveform/csv.hpp"

#include <bit>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <random>

#include "support/scratch.hpp"
#include "waveform/output_file.hpp"

using namespace pwlsim;
using test::Scratch;
using waveform::csv_field;
using waveform::shortest;

namespace {

std::string csv_of(const std::vector<std::string>& names, const std::vector<double>& values) {
  const Scratch scratch;
  std::string problem;
  auto file = waveform::OutputFile::open(scratch / "a.csv", problem);
  REQUIRE(file);
  waveform::CsvWriter writer(*file, names);
  REQUIRE(writer.write(values));
  REQUIRE(writer.flush());
  REQUIRE(file->commit());
  return test::read_file(scratch / "a.csv");
}

}  // namespace

TEST_CASE("fields are quoted as RFC 4180 section 2 rules 6 and 7 say", "[unit]") {
  CHECK(csv_field("v(out)") == "v(out)");
  CHECK(csv_field("v(a,b)") == "\"v(a,b)\"");
  CHECK(csv_field("say \"x\"") == "\"say \"\"x\"\"\"");
  CHECK(csv_field("two\nlines") == "\"two\nlines\"");
  CHECK(csv_field("").empty());
}

TEST_CASE("numbers have the fewest digits that read back", "[unit]") {
  // The nearest doubles of IEEE 754: 0.1 + 0.2 is one unit in the last place above 0.3; the least and the greatest double.
  CHECK(shortest(0.3) == "0.3");
  CHECK(shortest(0.1 + 0.2) == "0.30000000000000004");
  CHECK(shortest(1e-6) == "1e-06");
  CHECK(shortest(-0.5) == "-0.5");
  CHECK(shortest(std::bit_cast<double>(std::uint64_t{1})) == "5e-324");
  CHECK(shortest(-1.7976931348623157e308) == "-1.7976931348623157e+308");
  CHECK(shortest(123456.0) == "123456");
}

TEST_CASE("a file has one header line and one line a row", "[unit]") {
  CHECK(csv_of({"time", "v(a,b)", "i(L1)"}, {0, 1, -2.5, 0.1, 3, 1e-9}) == "time,\"v(a,b)\",i(L1)\n0,1,-2.5\n0.1,3,1e-09\n");
  CHECK(csv_of({"time", "v(a)"}, {}) == "time,v(a)\n");
}

TEST_CASE("any double reads back unchanged, across buffer borders too", "[property]") {
  const unsigned seed = 20240611;
  INFO("seed " << seed);
  std::mt19937_64 random(seed);
  std::vector<double> values;
  while (values.size() < 60000) {
    const double value = std::bit_cast<double>(random());
    if (std::isfinite(value)) values.push_back(value);
  }
  const std::string text = csv_of({"time", "a", "b"}, values);
  const char* position = text.c_str() + text.find('\n') + 1;
  std::size_t wrong = 0;
  for (const double expected : values) {
    char* end = nullptr;
    const double read = std::strtod(position, &end);
    wrong += std::bit_cast<std::uint64_t>(read) == std::bit_cast<std::uint64_t>(expected) ? 0 : 1;
    REQUIRE((*end == ',' || *end == '\n'));
    position = end + 1;
  }
  CHECK(wrong == 0);
  CHECK(*position == '\0');
}

TEST_CASE("a row wider than the buffer is written whole", "[unit]") {
  std::vector<std::string> names(20000, "v");
  const std::vector<double> row(names.size(), -1.2345678901234567e-300);
  const std::string text = csv_of(names, row);
  CHECK(std::count(text.begin(), text.end(), '\n') == 2);
  CHECK(std::count(text.begin(), text.end(), ',') == 2 * 19999);
}

TEST_CASE("a row of five columns costs at most a microsecond", "[long]") {
  const std::size_t rows = 1000000;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> block(5 * 1000);
  for (double& value : block) value = uniform(random);
  std::string problem;
  auto file = waveform::OutputFile::open("/dev/null", problem);
  REQUIRE(file);
  waveform::CsvWriter writer(*file, std::vector<std::string>(5, "v"));
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t written = 0; written < rows; written += 1000) REQUIRE(writer.write(block));
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  INFO(elapsed.count() / double(rows) * 1e9 << " ns a row");
  CHECK(elapsed.count() < 1e-6 * double(rows));
}
