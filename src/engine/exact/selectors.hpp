#pragma once
/// The selectors of all islands: the modes that runs of one model have visited, kept from run to run.

#include <memory>
#include <vector>

#include "engine/exact/exact_model.hpp"
#include "engine/run.hpp"
#include "model/selection.hpp"

namespace pwlsim::engine {

class Selectors {
 public:
  Selectors(const ExactModel& model, NonUnique non_unique) {
    const model::Several several = non_unique == NonUnique::first ? model::Several::first : model::Several::stay;
    for (const IslandModel& island : model.islands) list_.push_back(std::make_unique<model::Selector>(island.extraction.system, several));
  }
  [[nodiscard]] model::Selector& of(std::size_t island) { return *list_[island]; }

 private:
  std::vector<std::unique_ptr<model::Selector>> list_;
};

}  // namespace pwlsim::engine
