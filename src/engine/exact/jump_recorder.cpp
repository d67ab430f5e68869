#include "engine/exact/jump_recorder.hpp"

#include <cmath>

#include "engine/exact/tolerances.hpp"
#include "engine/remarks.hpp"

namespace pwlsim::engine {

void JumpRecorder::keep(std::size_t island, const std::vector<double>& x) {
  if (jumps_.size() >= most_jumps_kept) return;
  before_[island].x = Eigen::Map<const model::Vector>(x.data(), static_cast<Eigen::Index>(x.size()));
  before_[island].impulse.resize(0);
  before_[island].higher_order = false;
}

void JumpRecorder::add(std::size_t island, const model::Selected& selected) {
  if (before_.empty()) return;
  Open& open = before_[island];
  if (open.impulse.size() == 0)
    open.impulse = selected.details->impulse;
  else
    open.impulse += selected.details->impulse;
  open.higher_order |= selected.details->higher_order;
}

std::vector<Jump::PortImpulse> JumpRecorder::impulses(std::size_t island, const Open& open) const {
  const model::System& system = islands_[island].extraction.system;
  std::vector<Jump::PortImpulse> result;
  const double largest = open.impulse.cwiseAbs().maxCoeff();
  for (int i = 0; i < system.ports; ++i) {
    const model::Port& port = system.port[static_cast<std::size_t>(i)];
    if (port.is_of_leak || std::abs(open.impulse[i]) <= tolerance::impulse * largest) continue;
    const auto diodes = static_cast<int>(islands_[island].island.network.diodes.size());
    const bool is_multiplier = i >= diodes && i < system.diodes;
    // A voltage port's u blocks; of a switch, which has no such direction, the flux counts from its first node to its second.
    const double sign = i >= system.diodes && !port.input_is_current ? -1.0 : 1.0;
    result.push_back({port.name, is_multiplier ? "s" : port.input_is_current ? "C" : "Vs", sign * open.impulse[i] * port.u_unit});
  }
  return result;
}

void JumpRecorder::closes(const IslandAt& at) {
  const std::size_t island = at.number;
  if (before_.empty() || before_[island].impulse.size() == 0 || jumps_.size() >= most_jumps_kept) return;
  const IslandModel& model = islands_[island];
  const model::StoreValues& stores = stores_.try_emplace(island, model.island, model.extraction).first->second;
  const Open& open = before_[island];
  const model::Vector now = Eigen::Map<const model::Vector>(at.run.x.data(), static_cast<Eigen::Index>(at.run.x.size()));
  const model::Vector old_values = stores.values(open.x);
  const model::Vector new_values = stores.values(now);
  Jump jump;
  jump.time = at.time;
  jump.impulses = impulses(island, open);
  jump.higher_order = open.higher_order;
  jump.energy_before = stores.energy(open.x);
  jump.energy_after = stores.energy(now);
  for (Eigen::Index i = 0; i < old_values.size(); ++i) {
    const double size = std::max(std::abs(old_values[i]), std::abs(new_values[i]));
    if (std::abs(new_values[i] - old_values[i]) > tolerance::change * size)
      jump.states.push_back({stores.names()[static_cast<std::size_t>(i)], old_values[i], new_values[i]});
  }
  jumps_.push_back(std::move(jump));
  before_[island].impulse.resize(0);
}

}  // namespace pwlsim::engine
