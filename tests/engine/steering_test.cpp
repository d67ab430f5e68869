/// Groups of islands that steer each other's switches.
#include "engine/exact/steering.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace pwlsim::engine;

TEST_CASE("islands that steer each other are one group, behind those that steer them", "[unit]") {
  // 4 steers 1 and 0; 1, 2 and 3 steer each other in a ring; 3 steers 0. 5 has nothing to do with them, but for itself.
  const auto groups = steering_groups(6, {{4, 1}, {1, 2}, {2, 3}, {3, 1}, {3, 0}, {4, 0}, {5, 5}});
  REQUIRE(groups.size() == 4);
  const auto group_of = [&](std::size_t island) {
    const auto at = std::find_if(groups.begin(), groups.end(), [&](const SteeringGroup& group) {
      return std::find(group.islands.begin(), group.islands.end(), island) != group.islands.end();
    });
    REQUIRE(at != groups.end());
    return static_cast<std::size_t>(at - groups.begin());
  };
  CHECK(groups[group_of(1)].islands == std::vector<std::size_t>{1, 2, 3});
  CHECK(groups[group_of(1)].steered_by == std::vector<std::size_t>{group_of(4)});
  CHECK(group_of(4) < group_of(1));
  CHECK(group_of(1) < group_of(0));
  std::vector<std::size_t> both{group_of(1), group_of(4)};
  std::sort(both.begin(), both.end());
  CHECK(groups[group_of(0)].steered_by == both);
  CHECK(groups[group_of(5)].islands.size() == 1);
  CHECK(groups[group_of(5)].steered_by.empty());
}

TEST_CASE("a long chain of islands is as many groups in its order", "[unit]") {
  constexpr std::size_t length = 100'000;
  std::vector<std::pair<std::size_t, std::size_t>> steers;
  for (std::size_t i = 0; i + 1 < length; ++i) steers.emplace_back(i + 1, i);
  const auto groups = steering_groups(length, steers);
  REQUIRE(groups.size() == length);
  for (std::size_t g = 0; g < length; ++g) REQUIRE(groups[g].islands == std::vector<std::size_t>{length - 1 - g});
}
