#include "engine/exact/loss_watch.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/exact/tolerances.hpp"

namespace pwlsim::engine {

std::string LossWatch::broken_currents(const model::StoreValues& stores, const model::Vector& before, const model::Vector& now) const {
  const model::Vector old_values = stores.values(before), new_values = stores.values(now);
  std::string names;
  for (Eigen::Index i = 0; i < old_values.size(); ++i) {
    const std::string& name = stores.names()[static_cast<std::size_t>(i)];
    if (!name.starts_with("i(") || std::abs(new_values[i] - old_values[i]) <= tolerance::least_broken_current * std::abs(old_values[i]))
      continue;
    names += fmt::format("{}{} from {:.4g} A to {:.4g} A", names.empty() ? "" : ", ", name, old_values[i], new_values[i]);
  }
  return names;
}

void LossWatch::jumped_by_switches(const IslandAt& island, const model::Vector& now, const std::vector<std::string>& switches) {
  const IslandModel& model = islands_[island.number];
  if (model.island.network.inductors.empty() || switches.empty()) return;
  const model::StoreValues& stores = stores_.try_emplace(island.number, model.island, model.extraction).first->second;
  const model::Vector& before = island.run.state_before();
  const double stored = stores.energy(before);
  const double lost = stores.magnetic_energy(before) - stores.magnetic_energy(now);
  if (!(lost > tolerance::least_loss * std::abs(stored)) || count_++ > 0) return;
  first_ = fmt::format(
      "at t = {:.6g} s {} {} a current that has no other path ({}): {:.3g} J of the {:.3g} J stored there are lost at once", island.time,
      fmt::join(switches, ", "), switches.size() > 1 ? "break" : "breaks", broken_currents(stores, before, now), lost, stored);
}

void LossWatch::hand_over(const RunEnd& /*end*/, Answer& answer) const {
  if (count_ == 0) return;
  answer.remarks.push_back(
      {"W-jump-loses-energy", fmt::format("{}{}; try a diode, a snubber or a finite Roff that gives the current a path", first_,
                                          count_ > 1 ? fmt::format(" (and so at {} more instants)", count_ - 1) : "")});
}

}  // namespace pwlsim::engine
