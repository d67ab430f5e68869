#pragma once
/// Records jumps at an instant: the impulses of the ports, the stores before and after, their energy.

#include <map>
#include <vector>

#include "engine/exact/exact_model.hpp"
#include "engine/exact/recorder.hpp"
#include "engine/run.hpp"
#include "model/store_values.hpp"

namespace pwlsim::engine {

class JumpRecorder : public Recorder {
 public:
  /// Nothing is kept unless `wanted`.
  JumpRecorder(const std::vector<IslandModel>& islands, bool wanted) : islands_(islands), before_(wanted ? islands.size() : 0) {}

  void opened(const IslandAt& island, const Opening& /*opening*/) {
    if (!before_.empty()) keep(island.number, island.run.x);
  }
  void selected(const IslandAt& island, const model::Selected& selected) {
    if (selected.jumps > 0) add(island.number, selected);
  }
  void closes(const IslandAt& island);
  void hand_over(const RunEnd& /*end*/, Answer& answer) { answer.jumps = std::move(jumps_); }

 private:
  void keep(std::size_t island, const std::vector<double>& x);
  void add(std::size_t island, const model::Selected& selected);
  struct Open {
    model::Vector x;
    model::Vector impulse;  ///< empty: no jump
    bool higher_order = false;
  };
  [[nodiscard]] std::vector<Jump::PortImpulse> impulses(std::size_t island, const Open& open) const;

  const std::vector<IslandModel>& islands_;
  std::vector<Open> before_;
  std::map<std::size_t, model::StoreValues> stores_;
  std::vector<Jump> jumps_;
};

}  // namespace pwlsim::engine
