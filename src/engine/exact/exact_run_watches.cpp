/// Accumulations and crowds of events, and what a run reports: why it ended early, remarks, statistics and the certificate.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <set>

#include "engine/exact/exact_run.hpp"
#include "engine/exact/tolerances.hpp"
#include "engine/remarks.hpp"

namespace pwlsim::engine {

namespace {

/// Elements with a port that is meant; ports of one element stand side by side, and it is named once.
template <typename IsMeant>
std::vector<std::string> port_names(const model::System& system, const IsMeant& is_meant) {
  std::vector<std::string> names;
  for (int i = 0; i < system.ports; ++i) {
    const std::string& name = system.port[static_cast<std::size_t>(i)].name;
    if (is_meant(i) && !system.port[static_cast<std::size_t>(i)].is_of_leak && (names.empty() || names.back() != name))
      names.push_back(name);
  }
  return names;
}

std::vector<std::string> all_names(const model::System& system) {
  return port_names(system, [](int) { return true; });
}

/// Elements with a port that is not on the same side in all of the modes.
std::vector<std::string> differing_elements(const model::System& system, const std::vector<const model::Mode*>& modes) {
  const model::IndexSet& first = modes.front()->active;
  return port_names(system, [&](int port) {
    return std::any_of(modes.begin(), modes.end(), [&](const model::Mode* m) { return m->active.contains(port) != first.contains(port); });
  });
}

}  // namespace

/// In a passive circuit no events accumulate ahead.
void ExactRun::watch_accumulation(const Instant& instant) {
  const double time = instant.time;
  if (all_passive_) return;
  for (IslandRun* running : running_) {
    IslandRun& island = *running;
    const Opened opened = opened_[number_of(island)];
    if (island.system().passive || opened == Opened::no) continue;
    AccumulationWatch& watch = island.accumulation();
    if (opened == Opened::from_outside || instant.flips) {  // what switches do infinitely often has no limit
      watch.reset();
      continue;
    }
    watch.note(time, reinterpret_cast<std::uintptr_t>(island.mode), island.x.data(), island.system().n);
    const auto limit = watch.limit();
    if (limit && may_cross(island, *limit, time)) cross(island, *limit);
  }
}

/// Near enough to the limit, which is well known, and nothing else happens before it: no row, no source edge, no event elsewhere.
bool ExactRun::may_cross(const IslandRun& island, const AccumulationWatch::Limit& limit, double time) {
  if (!limit.is_near(time)) return false;
  if (limit.time >= request_.stop || (rows_.next_time() > time + tolerance_ && rows_.next_time() < limit.time - tolerance_)) return false;
  for (const model::Clock& clock : clocks_)
    if (clock.next().time <= limit.time) return false;
  for (IslandRun* other : running_) {
    if (other->next_break() <= limit.time) return false;
    if (other != &island && other->certify(limit.time) < limit.time) return false;
  }
  return true;
}

void ExactRun::cross(IslandRun& island, const AccumulationWatch::Limit& limit) {
  answer_.remarks.push_back(island.accumulation().remark(limit, all_names(island.system()), tolerance_));
  ++answer_.statistics.accumulations;
  island.go_to_limit(limit);
  island.accumulation().reset();
}

bool ExactRun::watch_crowd(const Instant& instant) {
  return !crowd_.note(instant.time, tolerance::crowd * request_.stop) || fail_crowd(instant, crowd_);
}

/// Of instants at which a guard was passed and nothing happened, or nothing but flips of switches that change nothing.
bool ExactRun::watch_idle_crowd(const Instant& instant) {
  return !instant.crossing || !idle_crowd_.note(instant.time, tolerance::idle_crowd * request_.stop) || fail_crowd(instant, idle_crowd_);
}

/// The element whose guard was passed at the event at which the island was opened; empty where that is not known.
std::string ExactRun::passed_name(const IslandRun& island) const {
  const model::System& system = island.system();
  const int row = island.passed_row;
  if (row < 0) return {};
  if (row < system.diodes) return system.port[static_cast<std::size_t>(row)].name;
  const model::Control& control = system.controls[static_cast<std::size_t>(row - system.diodes) / 2];
  return model_.switches[static_cast<std::size_t>(control.driven)].name;
}

/// What changes sides at the instant, or else whose guard is passed.
std::vector<std::string> ExactRun::what_happens(const Instant& instant) const {
  std::vector<std::string> names;
  if (instant.flips)
    for (const int i : last_flips_) names.push_back(model_.switches[static_cast<std::size_t>(i)].name);
  for (std::size_t i = 0; i < islands_.size(); ++i)
    if (modes_before_[i] && islands_[i].mode && islands_[i].mode != modes_before_[i])
      for (auto& name : differing_elements(islands_[i].system(), {modes_before_[i], islands_[i].mode})) names.push_back(std::move(name));
  for (std::size_t i = 0; names.empty() && i < islands_.size(); ++i)
    if (opened_[i] == Opened::by_own_event) names.push_back(passed_name(islands_[i]));
  std::erase(names, std::string());
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

bool ExactRun::fail_crowd(const Instant& instant, const Crowd& crowd) {
  std::string part;
  for (std::size_t i = 0; i < islands_.size() && part.empty(); ++i)  // nothing but sources
    if (opened_[i] != Opened::no) part = "in the part with " + islands_[i].system().name;
  fail(accumulation(instant.time, crowd, what_happens(instant), part));
  return false;
}

void ExactRun::note_several(const IslandRun& island, const model::Selected& selected, double time) {
  if (several_++ > 0) return;
  several_text_ = fmt::format("the solution is not unique at t = {} s: {} may continue in {} ways", time,
                              fmt::join(differing_elements(island.system(), selected.details->continuations), ", "),
                              selected.details->continuations.size());
}

namespace {

/// Controlled sources, which a sign may make deliver energy: up to three names, "F1, E2 and others".
std::string controlled_sources(const model::Network& network) {
  constexpr std::size_t most = 3;
  std::vector<std::string> names;
  const auto add = [&](const auto& parts, const auto& form) {
    for (const auto& part : parts) {
      const std::string& name = part.label.name;
      const std::size_t dot = name.rfind('.');
      const char letter = name.empty() ? ' ' : name[dot == std::string::npos ? 0 : dot + 1];
      const auto& terms = part.*form;
      const bool is_controlled =
          std::any_of(terms.begin(), terms.end(), [](const model::Term& term) { return !model::is_independent(term); });
      if (is_controlled && std::string_view("EFGHefgh").find(letter) != std::string_view::npos) names.push_back(name);
    }
  };
  add(network.branches, &model::Branch::voltage);
  add(network.injections, &model::Injection::current);
  if (names.size() <= most) return fmt::format("{}", fmt::join(names, ", "));
  names.resize(most);
  return fmt::format("{} and others", fmt::join(names, ", "));
}

/// What may be wrong comes before the option that only chooses.
std::string advice_of(const IslandRun& island) {
  const std::string active = island.system().passive ? "" : controlled_sources(island.model().island.network);
  const std::string choice = ".options nonunique=stay";
  if (active.empty()) return "try " + choice;
  return fmt::format("the linear part is not passive with {}; try the other sign or a smaller gain there, or {}", active, choice);
}

}  // namespace

void ExactRun::fail_selection(const IslandRun& island, const model::Selected& selected, double time) {
  if (selected.outcome == model::SelectionOutcome::several) {
    const std::vector<std::string> names = differing_elements(island.system(), selected.details->continuations);
    fail(Outcome::not_unique, "E-not-unique",
         fmt::format("the solution is not unique at t = {} s: {} may continue in {} ways; {}", time, fmt::join(names, ", "),
                     selected.details->continuations.size(), advice_of(island)),
         names);
    return;
  }
  const std::vector<std::string> names = all_names(island.system());
  if (names.empty())
    return fail(Outcome::no_solution, "E-no-solution",
                fmt::format("no solution can be computed at t = {} s in the part with {}: its time constants are too short for double "
                            "precision; try larger capacitors and inductors there, or leave them out",
                            time, island.system().name),
                {});
  const bool jumps = selected.outcome == model::SelectionOutcome::too_many_jumps;
  fail(Outcome::no_solution, jumps ? "E-jump-cycle" : "E-no-solution",
       fmt::format("{} at t = {} s in the part with {}; try a small resistor in its loops of sources, capacitors and closed switches",
                   jumps ? "the state keeps jumping" : "no solution continues", time, fmt::join(names, ", ")),
       names);
}

void ExactRun::fail(Outcome outcome, std::string id, std::string text, std::vector<std::string> elements) {
  fail(Ending{outcome, std::move(id), std::move(text), std::move(elements)});
}

void ExactRun::fail(Ending ending) {
  answer_.mode = mode_text(ending.outcome);
  end_run(answer_, std::move(ending));
}

/// Where no solution continues the mode before the instant at hand is meant, else that which holds.
std::string ExactRun::mode_text(Outcome outcome) const {
  const bool holds = outcome == Outcome::interrupted || outcome == Outcome::sink_stopped;
  ModeText text;
  for (std::size_t i = 0; i < islands_.size(); ++i) {
    const model::Mode* mode = holds ? islands_[i].mode : modes_before_[i];
    if (mode == nullptr) continue;
    const auto& ports = islands_[i].system().port;
    for (std::size_t k = 0; k < ports.size(); ++k)
      if (!ports[k].is_of_leak) text.add(ports[k].name, mode->active.contains(static_cast<int>(k)) == ports[k].input_is_current);
  }
  return text.str();
}

void ExactRun::note_open_signals() {
  std::set<std::string> names;
  for (const auto& island : islands_)
    for (const std::size_t output : island.selector().modes().open_outputs())
      names.insert(model_.signal_names[static_cast<std::size_t>(island.system().output_signal[output])]);
  if (!names.empty()) answer_.remarks.push_back(indeterminate(names));
}

/// Whether charge and flux have gone on as impulses have it, and every port has kept its inequality up to here.
bool ExactRun::holds(const IslandRun& island) {
  if (island.continuity().is_broken()) {
    const ContinuityWatch::Break found = island.continuity().worst();
    const std::string store = model::StoreValues(island.model().island, island.model().extraction).of_coordinate(found.coordinate);
    fail(Outcome::no_solution, "E-no-solution",
         fmt::format("{} changes by {:.3g} of its largest value at t = {} s without an impulse; try --engine sparse, and report the deck",
                     store, found.share, found.time),
         {store});
    return false;
  }
  if (!island.guards().is_broken()) return true;
  const GuardWatch::Violation violation = island.guards().worst();
  fail(Outcome::no_solution, "E-no-solution",
       fmt::format("the mode is no longer valid: {}; the run has missed an event; try --engine sparse, and report the deck",
                   violation_text(island.system(), violation)),
       {island.system().port[static_cast<std::size_t>(violation.port)].name});
  return false;
}

void ExactRun::count() {
  Statistics& s = answer_.statistics;
  std::set<int> parts;
  for (const auto& island : islands_) parts.insert(island.model().island.part);
  s.islands = parts.size();
  for (const auto& island : islands_) {
    s.states += static_cast<std::uint64_t>(island.system().n);
    const auto of_leaks = std::count_if(island.system().port.begin(), island.system().port.end(), std::mem_fn(&model::Port::is_of_leak));
    s.ports += static_cast<std::uint64_t>(island.system().diodes - of_leaks);
    s.switches += static_cast<std::uint64_t>(island.system().ports - island.system().diodes);
    if (island.system().ports > 0) s.modes_visited += island.selector().modes().visited();  // others have but one
    s.lcp_pivots += island.selector().pivots();
    s.steps += island.locator().intervals();
  }
  s.modes_visited = std::max<std::uint64_t>(s.modes_visited, 1);
  s.seconds_model = model_.seconds;
}

/// Events that were found less surely than others.
void ExactRun::note_doubtful_events() {
  for (const auto& island : islands_) {
    if (const std::uint64_t coarse = island.coarse_selections(); coarse > 0)
      answer_.remarks.push_back(
          {"N-coarse-selection",
           fmt::format("at t = {} s{} the next mode of the part with {} was accepted only at {:.0e} times the rounding level: events there "
                       "are within rounding of each other; the certificate counts the remaining violation",
                       island.first_coarse(), coarse > 1 ? fmt::format(" (and {} more times)", coarse - 1) : "", island.system().name,
                       model::coarsest_relaxation)});
    if (island.locator().sampled() > 0)
      answer_.remarks.push_back(
          {"W-events-sampled",
           fmt::format("in {} segments of the part with {} events were searched at {} points only: parts of it are too fast for "
                       "guaranteed bounds; try larger Ron, or no Roff, beside small capacitors and inductors",
                       island.locator().sampled(), island.system().name, 1024)});
  }
}

void ExactRun::note_choices() {
  if (several_ == 0) return;
  answer_.remarks.push_back(
      {"N-not-unique",
       fmt::format("{}{}; {} was taken (nonunique={})", several_text_,
                   several_ > 1 ? fmt::format(" (nor at {} later instants)", several_ - 1) : "",
                   request_.non_unique == NonUnique::first ? "the first" : "the previous mode, or else the first one found,",
                   request_.non_unique == NonUnique::first ? "first" : "stay")});
}

void ExactRun::certify() {
  const auto clock = std::chrono::steady_clock::now();
  Certificate& certificate = answer_.certificate;
  if (!watching_.leaves_end_open) certificate = recorders_.certificate();
  for (const auto& island : islands_) {
    certificate.complementarity = std::max(certificate.complementarity, island.guards().worst().share());
    // In the time t a rate that is off by δ moves what it drives by δt of itself.
    certificate.kcl_kvl =
        std::max({certificate.kcl_kvl, island.continuity().worst().share, island.selector().modes().rate_doubt() * request_.stop});
  }
  const double worst = std::max({certificate.complementarity, certificate.kcl_kvl, certificate.energy});
  if (worst > tolerance::doubtful_residual) answer_.remarks.push_back(doubtful_certificate(worst));
  certificate.has_passivity = true;
  certificate.passive = std::all_of(islands_.begin(), islands_.end(), [](const IslandRun& island) { return island.system().passive; });
  answer_.statistics.seconds_certificate = std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
}

void ExactRun::finish() {
  count();
  note_doubtful_events();
  if (!watching_.leaves_end_open) note_open_signals();  // costs a mode or two for each that was visited
  recorders_.hand_over({clocks_, on_}, answer_);
  note_choices();
  certify();
  answer_.remarks.insert(answer_.remarks.begin(), model_.remarks.begin(), model_.remarks.end());
}

}  // namespace pwlsim::engine
