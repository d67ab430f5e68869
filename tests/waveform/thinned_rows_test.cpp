#include "waveform/thinned_rows.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using pwlsim::waveform::ThinnedRows;
using Numbers = std::vector<double>;

TEST_CASE("few rows are kept as they are", "[unit]") {
  ThinnedRows thinned(0.0, 1.0, 2, 3);
  for (double t : {0.0, 0.5, 1.0}) thinned.add(Numbers{t, 2.0 * t, -t});
  CHECK_FALSE(thinned.thinned());
  CHECK(thinned.rows().times == Numbers{0.0, 0.5, 1.0});
  CHECK(thinned.rows().columns == std::vector<Numbers>{{0.0, 1.0, 2.0}, {0.0, -0.5, -1.0}});
}

TEST_CASE("of many rows the extremes of each piece of time stay, in their order", "[unit]") {
  ThinnedRows thinned(0.0, 2.0, 1, 4);  // two pieces of 1 s
  for (const auto& [t, value] :
       std::vector<std::pair<double, double>>{{0.0, 1.0}, {0.2, 5.0}, {0.4, 3.0}, {1.0, 7.0}, {1.5, -2.0}, {2.0, 0.0}})
    thinned.add(Numbers{t, value});
  REQUIRE(thinned.thinned());
  const auto rows = thinned.rows();
  CHECK(rows.times == Numbers{0.0, 0.4, 1.0, 2.0});
  CHECK(rows.columns[0] == Numbers{1.0, 5.0, 7.0, -2.0});
}

TEST_CASE("memory is bounded and a spike of one row among millions stays", "[unit]") {
  constexpr int count = 2'000'000;
  ThinnedRows thinned(0.0, count, 1, 1000);
  for (int k = 0; k <= count; ++k) thinned.add(Numbers{static_cast<double>(k), k == 1'234'567 ? 9.0 : std::sin(k)});
  const auto rows = thinned.rows();
  CHECK(rows.times.size() <= 1000);
  CHECK(std::is_sorted(rows.times.begin(), rows.times.end()));
  CHECK(*std::max_element(rows.columns[0].begin(), rows.columns[0].end()) == 9.0);
}

TEST_CASE("a run that ends early leaves the rest of its pieces out", "[unit]") {
  ThinnedRows thinned(0.0, 100.0, 1, 4);
  for (int k = 0; k < 10; ++k) thinned.add(Numbers{static_cast<double>(k), 1.0});
  CHECK(thinned.rows().times == Numbers{0.0, 9.0});
}
