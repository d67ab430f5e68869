#pragma once
/// Records jumps at an instant: the impulses of the ports, the stores before and after, their energy.

#include <map>
#include <vector>

#include "engine/exact/exact_model.hpp"
#include "engine/run.hpp"
#include "model/selection.hpp"
#include "model/store_values.hpp"

namespace pwlsim::engine {

class JumpRecorder {
 public:
  /// Nothing is kept unless `wanted`.
  JumpRecorder(const std::vector<IslandModel>& islands, bool wanted) : islands_(islands), before_(wanted ? islands.size() : 0) {}

  /// The state x = (ξ, ζ) of an island before the instant.
  void before(std::size_t island, const std::vector<double>& x) {
    if (!before_.empty()) keep(island, x);
  }
  /// A selection in it has jumped.
  void jumped(std::size_t island, const model::Selected& selected);
  /// The state after the instant.
  void after(std::size_t island, double time, const std::vector<double>& x);
  [[nodiscard]] std::vector<Jump> take() { return std::move(jumps_); }

 private:
  void keep(std::size_t island, const std::vector<double>& x);
  struct Open {
    model::Vector x;
    model::Vector impulse;  ///< empty: no jump
    bool higher_order = false;
  };
  [[nodiscard]] std::vector<Jump::Impulse> impulses(std::size_t island, const Open& open) const;

  const std::vector<IslandModel>& islands_;
  std::vector<Open> before_;
  std::map<std::size_t, model::StoreValues> stores_;
  std::vector<Jump> jumps_;
};

}  // namespace pwlsim::engine
