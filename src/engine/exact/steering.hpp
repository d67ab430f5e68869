#pragma once
/// Finds islands that must be followed together: those that drive each other's switches, directly or indirectly.

#include <cstddef>
#include <utility>
#include <vector>

namespace pwlsim::engine {

/// Islands that steer each other, and the groups (by their number) that steer them. Other islands do not affect them.
struct SteeringGroup {
  std::vector<std::size_t> islands;
  std::vector<std::size_t> steered_by;
};

/// Groups of the islands 0 … count−1 in an order in which a group follows those that steer it; within a group islands keep their order.
/// `steers`: pairs (island that holds a control, island that holds its switch).
[[nodiscard]] std::vector<SteeringGroup> steering_groups(std::size_t count, const std::vector<std::pair<std::size_t, std::size_t>>& steers);

}  // namespace pwlsim::engine
