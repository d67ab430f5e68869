#include "measure/solution_record.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace pwlsim;
using measure::SolutionRecord;
using std::numbers::pi;

namespace {

/// The pieces of sin(2π t) and of the straight line t from 0 to `end`.
void feed(SolutionRecord& record, double end, int pieces) {
  const auto& point = linalg::gauss_legendre().point;
  std::vector<double> values(2 * linalg::legendre_points);
  for (int k = 0; k < pieces; ++k) {
    const double from = end * k / pieces, to = end * (k + 1) / pieces;
    for (std::size_t i = 0; i < linalg::legendre_points; ++i) {
      const double time = from + 0.5 * (point[i] + 1.0) * (to - from);
      values[i] = std::sin(2.0 * pi * time);
      values[linalg::legendre_points + i] = time;
    }
    record.take({from, to, from, to - from, values});
  }
}

/// ∫ and ∫ of the square of the first signal over the whole record.
std::pair<double, double> integrals(const SolutionRecord& record, const std::vector<SolutionRecord::Bin>& bins) {
  double area = 0.0, square = 0.0;
  for (const auto& bin : bins) {
    area += (bin.to - bin.from) * bin.shares[0].mean;
    square += (bin.to - bin.from) * bin.shares[0].square;
  }
  const auto& rule = linalg::gauss_legendre();
  for (const auto& piece : record.pieces()) {
    const linalg::LegendreSeries series = measure::series_of(piece, 0);
    for (std::size_t i = 0; i < linalg::legendre_points; ++i) {
      const double value = series(rule.point[i]), weight = 0.5 * (piece.to - piece.from) * rule.weight[i];
      area += weight * value;
      square += weight * value * value;
    }
  }
  return {area, square};
}

}  // namespace

TEST_CASE("a short run is kept in full, and its line has every extremum", "[unit]") {
  SolutionRecord record(0.0, 2.3, 2);
  feed(record, 2.3, 7);
  CHECK_FALSE(record.is_thinned());
  CHECK(record.pieces().size() == 7);
  CHECK(record.pieces().front().lengths[1] == 2);  // a straight line has two coefficients
  const SolutionRecord::Line line = record.line(0);
  const auto [least, largest] = std::minmax_element(line.values.begin(), line.values.end());
  CHECK(*least == Approx(-1.0).epsilon(1e-12));
  CHECK(*largest == Approx(1.0).epsilon(1e-12));
  for (std::size_t k = 0; k < line.times.size(); ++k) REQUIRE(line.values[k] == Approx(std::sin(2.0 * pi * line.times[k])).margin(1e-11));
}

TEST_CASE("of a long run the end is kept in full, and of the rest exact statistics", "[unit]") {
  constexpr double end = 2.3;
  constexpr std::size_t sharers = 1000;  // room for 150 coefficients
  SolutionRecord record(0.0, end, 2, sharers);
  feed(record, end, 20'000);
  REQUIRE(record.is_thinned());
  CHECK(record.pieces().size() < 60);
  CHECK(record.pieces().back().to == end);
  for (const std::size_t most : {2000U, 300U, 1U}) {
    const auto bins = record.bins(most);
    CHECK(bins.size() <= most);
    CHECK(bins.back().to == record.pieces().front().from);
    const auto [area, square] = integrals(record, bins);
    // ∫ sin = (1 − cos 2πT)/2π, ∫ sin² = T/2 − sin(4πT)/8π
    CHECK(area == Approx((1.0 - std::cos(2.0 * pi * end)) / (2.0 * pi)).epsilon(1e-11));
    CHECK(square == Approx(0.5 * end - std::sin(4.0 * pi * end) / (8.0 * pi)).epsilon(1e-11));
    for (const auto& bin : bins) {
      REQUIRE(bin.shares[1].least == Approx(bin.from).margin(1e-12));
      REQUIRE(bin.shares[1].largest == Approx(bin.to).margin(1e-12));
      REQUIRE(bin.shares[1].mean == Approx(0.5 * (bin.from + bin.to)).margin(1e-12));
    }
  }
  CHECK(record.bins(1)[0].shares[0].largest == Approx(1.0).epsilon(1e-12));
  CHECK(record.bins(1)[0].shares[0].least == Approx(-1.0).epsilon(1e-12));
}
