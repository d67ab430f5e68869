#pragma once
/// The modes of a system that have been visited: each is built at its first visit, and so is its slow motion. With each set, what followed it.

#include <array>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include "model/index_set.hpp"
#include "model/mode.hpp"
#include "model/slow_manifold.hpp"
#include "model/system.hpp"
#include "model/valves.hpp"

namespace pwlsim::model {

class ModeStore {
 public:
  explicit ModeStore(const System& system) : system_(system), shifted_(system) {}

  /// `after` followed where x lay in `through`, which did not go on.
  struct Way {
    const Mode *through, *after;
  };
  /// The data of a set.
  struct Known {
    std::unique_ptr<Mode> mode;  ///< empty: not built yet
    std::unique_ptr<Mode> slow;  ///< its slow motion; empty: not built yet, or there is none
    std::unique_ptr<Mode>
        brief;  ///< the mode without only those decays that are not followed, if `slow` leaves out others, too; else empty
    std::unique_ptr<Mode> apart;  ///< the mode in coordinates in which `slow` stands apart; empty: not built yet, or not needed
    bool apart_is_known = false;
    bool slow_is_known = false;
    std::vector<const Mode*> successors;  ///< modes that followed this wanted set, the last one first
    std::vector<Way> ways;                ///< what followed by way of another mode
    const Mode* richer = nullptr;         ///< the mode with its free ports active, if that is another one
    bool richer_is_known = false;
  };
  /// Of the set with its blocked ports held.
  Known& known(const IndexSet& wanted);
  /// The mode of a set.
  const Mode& mode(const IndexSet& set);
  /// Its slow motion, if it has much faster decays; else null.
  const Mode* slow_mode(const IndexSet& set);
  /// In which the run goes on: the same mode, its slow motion apart where its own coordinates have too few digits for both.
  const Mode& followed(const Mode& mode);
  const Mode& followed(const IndexSet& set) {
    static_cast<void>(slow_mode(set));
    return followed(mode(set));
  }
  /// Whether the mode's rates are fast enough for that.
  [[nodiscard]] bool may_split(const Mode& whole) const;
  /// Decays that end within `time`, s, are not followed. Before the first slow motion is asked for.
  void set_unseen(double time) { unseen_ = time; }
  [[nodiscard]] double unseen() const { return unseen_; }

  void remember(const IndexSet& wanted, const Mode& after);
  void remember_way(const IndexSet& wanted, const Way& way);

  void mark_visited(const Mode& mode);
  [[nodiscard]] std::uint64_t visited() const { return visited_; }
  /// Numbers of the system's outputs that some visited mode does not determine (rows have their least-norm value).
  [[nodiscard]] std::vector<std::size_t> open_outputs() const;
  /// The largest doubt of a rate (Decays::rate_doubt) of the visited modes, 1/s.
  [[nodiscard]] double rate_doubt() const;

 private:
  using Entry = std::pair<const IndexSet, Known>;
  Entry& look_up(const IndexSet& set);
  void split(Known& about, const Mode& whole);
  std::unique_ptr<Mode> build_apart(const Known& about, const Mode& whole);
  std::unique_ptr<Mode> apart(const Known& about, const Mode& whole, const Mode& mode, const Rates& rates, double time);
  [[nodiscard]] Matrix open_directions(const Mode& mode) const;

  const System& system_;
  ShiftedSystems shifted_;
  std::unordered_map<IndexSet, Known, IndexSet::Hash> known_;
  std::array<Entry*, 4> recent_{};  ///< the ones used last
  std::size_t next_recent_ = 0;
  IndexSet held_;
  double unseen_ = 0.0;  ///< s
  std::uint64_t visited_ = 0;
};

inline ModeStore::Known& ModeStore::known(const IndexSet& wanted) {
  if (!system_.valves.empty()) hold_blocked(system_, held_ = wanted);
  const IndexSet& set = system_.valves.empty() ? wanted : held_;
  for (Entry* entry : recent_)
    if (entry && entry->first == set) return entry->second;
  return look_up(set).second;
}

}  // namespace pwlsim::model
