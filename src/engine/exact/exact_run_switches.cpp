/// ExactRun: what happens at one instant. Switches and modes answer each other until nothing moves.

#include <utility>

#include "engine/exact/exact_run.hpp"
#include "engine/remarks.hpp"
#include "engine/switch_rounds.hpp"

namespace pwlsim::engine {

/// Sources have moved: first the switches that only they drive, so that no mode between two positions is ever entered; then modes, and what those do to
/// the other switches, until nothing moves. Parts without states have their turn first, then those with states, at last those that steer nothing: logic
/// that settles reaches them as one change, however long its chains are.
bool ExactRun::settle(Instant& instant, bool at_start) {
  std::fill(rested_.begin(), rested_.end(), 0);
  InstantRounds rounds;
  for (bool is_first = true; rounds.next(); is_first = false) {
    if (rounds.is_late())
      for (const int i : last_flips_) rounds.note_late(static_cast<std::size_t>(i));
    if (flip_without_mode(instant, at_start && is_first) || (!sensing_.empty() && flip_passing(instant))) continue;
    if (!logic_.empty() && select_logic(instant)) continue;
    if (!select_open(steering_, instant)) return false;
    if (!sensing_.empty() && (flip_violated(instant) || flip_at_rest(instant))) continue;
    if (!select_open(following_, instant)) return false;
    note_mode_changes(instant);
    recorders_.settled(instant.time, !at_start || !is_start_given_);
    for (IslandRun* island : running_) {
      if (!island->is_open()) continue;
      recorders_.closes(at(*island, instant.time));
      if (instant.jumps > 0 && instant.flips && !at_start) note_loss(*island, instant);
      island->close(instant.time, on_);
      recorders_.closed(at(*island, instant.time));
    }
    is_ended_by_observer_ = !recorders_.instant_ended(instant.time, instant.jumps > 0, on_);
    return true;
  }
  std::vector<std::string> names;
  for (const std::size_t i : rounds.restless()) names.push_back(model_.switches[i].name);
  fail(keeps_toggling(instant.time, std::move(names)));
  return false;
}

bool ExactRun::select_open(const std::vector<IslandRun*>& islands, Instant& instant) {
  for (IslandRun* island : islands) {
    if (!island->is_open() || is_ready_[number_of(*island)] != 0 || selects(*island, instant)) continue;
    fail_selection(*island, island->selected(), instant.time);
    return false;
  }
  return true;
}

/// Whether something continues.
bool ExactRun::selects(IslandRun& island, Instant& instant) {
  const model::Selected& selected = island.select();
  instant.jumps += selected.jumps;
  recorders_.selected(at(island, instant.time), selected);
  if (selected.outcome == model::SelectionOutcome::found) return true;
  if (selected.outcome != model::SelectionOutcome::several || request_.non_unique == NonUnique::error) return false;
  note_several(island, selected, instant.time);
  return true;
}

/// Modes of the parts without states; true where switches have answered them. Between two rounds such a part may have no mode, as where a closed switch waits for
/// its complement behind more gates: its controls wait for the next.
bool ExactRun::select_logic(Instant& instant) {
  std::fill(is_ready_.begin(), is_ready_.end(), 0);
  for (IslandRun* island : logic_)
    if (island->is_open() && selects(*island, instant)) is_ready_[number_of(*island)] = 1;
  return flip_logic(instant);
}

void ExactRun::take_clocks(Instant& instant) {
  for (model::Clock& clock : clocks_) {
    if (clock.next().time > instant.time + tolerance_) continue;
    instant.source_edge |= clock.next().is_edge;
    if (clock.next().flips) flips_.push_back(clock.driven());
    clock.take();
  }
}

/// To `flips_`: the switches of the controls that each open island names.
template <class Controls>
void ExactRun::add_flips(const std::vector<IslandRun*>& islands, const Controls& controls) {
  for (IslandRun* island : islands) {
    if (!island->is_open()) continue;
    for (const int c : controls(*island)) flips_.push_back(island->system().controls[static_cast<std::size_t>(c)].driven);
  }
}

bool ExactRun::flip_without_mode(Instant& instant, bool at_start) {
  flips_.clear();
  take_clocks(instant);
  add_flips(steering_,
            [&](IslandRun& island) -> const std::vector<int>& { return island.violated_without_mode(instant.time, on_, at_start); });
  return flip(instant);
}

/// What passes at one instant with switches that have been set already, by its mode of before: no position between the two is entered.
bool ExactRun::flip_passing(Instant& instant) {
  flips_.clear();
  add_flips(sensing_, [&](IslandRun& island) -> const std::vector<int>& { return island.passing_controls(on_); });
  return flip(instant);
}

/// Gates settle before latches: a switch with hysteresis keeps what it was told until nothing else moves.
bool ExactRun::flip_logic(Instant& instant) {
  flips_.clear();
  bool latches = true;
  for (IslandRun* island : logic_) {
    if (is_ready_[number_of(*island)] == 0) continue;
    for (const int c : island->violated_controls(on_)) {
      const model::Control& control = island->system().controls[static_cast<std::size_t>(c)];
      const bool is_latch = control.on_level != control.off_level;
      if (latches && !is_latch) flips_.clear();
      latches = latches && is_latch;
      if (is_latch == latches) flips_.push_back(control.driven);
    }
  }
  return flip(instant);
}

/// All switches whose control has passed at this instant change together.
bool ExactRun::flip_violated(Instant& instant) {
  flips_.clear();
  add_flips(sensing_, [&](IslandRun& island) -> const std::vector<int>& { return island.violated_controls(on_); });
  return flip(instant);
}

/// Where nothing is violated any more: the switches whose control rests at a threshold that counts as passed. A switch that changes back holds its
/// control there by itself, and stays.
bool ExactRun::flip_at_rest(Instant& instant) {
  flips_.clear();
  for (IslandRun* island : sensing_) {
    if (!island->is_open()) continue;
    for (const int c : island->controls_at_rest(on_)) {
      const int driven = island->system().controls[static_cast<std::size_t>(c)].driven;
      if (std::exchange(rested_[static_cast<std::size_t>(driven)], 1) == 0) flips_.push_back(driven);
    }
  }
  return flip(instant);
}

/// The switches of flips_; true if there are any.
bool ExactRun::flip(Instant& instant) {
  if (flips_.empty()) return false;
  instant.flips = true;
  std::swap(flips_, last_flips_);
  for (const int s : last_flips_) {
    const auto index = static_cast<std::size_t>(s);
    on_[index] = on_[index] == 0;
    if (instant.time > begin_) recorders_.flipped(s);
    const SwitchInfo& info = model_.switches[index];
    if (info.island < 0) continue;
    IslandRun& island = islands_[static_cast<std::size_t>(info.island)];
    if (!island.is_open()) open_island(island, instant);
    island.set_switch(info.port, on_[index] != 0);
  }
  return true;
}

}  // namespace pwlsim::engine
