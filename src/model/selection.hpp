#pragma once
/// Selects the mode that follows from a state, and the jump into it.
///
/// Candidates, in this order: the current mode and modes that followed it before (these first if the solution is known to be unique); the port whose
/// guard reached zero flipped, then all ports with falling guards; candidates of the rational complementarity problem (RCP) at growing s (Lemke); the
/// neighbourhood of the current mode. A mode is taken only when verified in its own differential equation (Verifier), which is correct for any
/// relative degree.

#include <string>
#include <unordered_map>
#include <vector>

#include "model/decaying_sum.hpp"
#include "model/impulse.hpp"
#include "model/mode_store.hpp"
#include "model/rcp.hpp"
#include "model/verify.hpp"

namespace pwlsim::model {

/// `several`: `mode` is one of different continuations.
enum class SelectionOutcome { found, none, several, too_many_jumps };

/// The choice among different continuations: the first in the order of the ports, or the previous mode if it is one of them.
enum class Several { first, stay };

/// Further results.
struct Details {
  Vector impulse;                          ///< of the jumps: ∫u dt of all ports over the instant, in u·s; first order, least norm
  bool higher_order = false;               ///< derivatives of impulses occurred, too
  int order = 0;                           ///< order of the highest; if not known, the largest possible
  std::vector<const Mode*> continuations;  ///< with `several`: one mode of each different continuation
};

struct Selected {
  SelectionOutcome outcome = SelectionOutcome::found;
  const Mode* mode = nullptr;
  int jumps = 0;
  bool settles = false;              ///< decays that are not followed moved the state, be it on the way to a mode that has none
  double relaxation = 1.0;           ///< largest factor on the rounding level that the verification needed, over all jumps
  const Details* details = nullptr;  ///< after jumps and with `several`
};

/// The last rounding level of the verification: `Selected::relaxation` of a mode that no finer level accepts.
inline constexpr double coarsest_relaxation = 1e4;

/// With up to this many ports all modes are tried if nothing else helps, and for further continuations.
inline constexpr int few_ports = 6;

class Selector {
 public:
  Selector(const System& system, Several several);

  /// x (system.size() entries) holds the state before, ζ already right of the instant; on return the state after all jumps.
  /// `wanted`: previous mode's set with the switch ports in their present positions. `trigger`: port whose guard reached zero, −1: none.
  /// Valid until the next selection.
  const Selected& select(double* x, const IndexSet& wanted, int trigger);
  /// The answer of the last selection.
  [[nodiscard]] const Selected& selected() const { return selected_; }
  /// The answer if there is nothing to select.
  const Selected& stay_in(const Mode& mode);

  /// The modes, each as it was built at its first visit.
  [[nodiscard]] ModeStore& modes() { return modes_; }
  [[nodiscard]] const ModeStore& modes() const { return modes_; }
  /// The next state to select for comes from this mode after its decays have ended, so it lies in its slow motion; null: none.
  void set_settled(const Mode* mode) { settled_mode_ = mode; }
  /// Decays that end within `time`, s, and take no guard to zero, are not followed: x moves to the slow manifold at once.
  void set_unseen(double time) {
    modes_.set_unseen(time);
    verifier_.set_unseen(time);
  }
  /// Ports whose shares are free all count as conducting, although no signal reads the shares.
  void share_in_any_case() { ports_are_read_ = true; }
  /// Modes that the last selection jumped into on its way, in order; the mode it ended in is not among them, unless it jumped into that one, too.
  [[nodiscard]] const std::vector<const Mode*>& jumped_into() const { return jumped_into_; }
  [[nodiscard]] std::uint64_t pivots() const { return rational_.pivots(); }
  /// The verifier, at the rounding level that the last selection needed.
  [[nodiscard]] Verifier& verifier() { return verifier_; }
  /// The rule J = (I \ Γ2) ∪ Γ1 of van der Schaft & Schumacher's earlier paper: from I every port changes sides whose guard is about to fall
  /// below zero (Γ1 of the inactive, Γ2 of the active ones). A first guess only: if it implies a jump, the jump may be adhesive.
  [[nodiscard]] IndexSet by_rule(const double* x, const IndexSet& set);
  /// Departures of all diode guards in the mode last selected; valid while `departures_hold_for` that mode.
  [[nodiscard]] const std::vector<Departure>& departures() const { return departures_; }
  [[nodiscard]] bool departures_hold_for(const Mode& mode) const { return departures_of_ == &mode; }
  /// Coordinates in that mode of x as `select` left it, where the selection has computed them; null elsewhere.
  [[nodiscard]] const double* coordinates(const Mode& mode) const { return coordinates_of_ == &mode ? y_.data() : nullptr; }
  /// Whether two modes, both consistent at x, continue as one solution.
  [[nodiscard]] bool continues_alike(const Mode& a, const Mode& b, const double* x) const;

 private:
  bool consistent(const Mode& mode, const double* x, double* projected) const;
  bool strictly_consistent(const Mode& mode, const double* x, double* projected) const;
  bool lies_in(const Mode& mode, const double* x);
  [[nodiscard]] bool has_settled(const Mode& slow) const;
  bool decays_unseen(const Mode& slow, const double* x);
  const Mode* holding(const double* x, const IndexSet& set);
  bool accepts(const Mode& mode, const double* x);
  bool is_violated(const Mode& mode, const double* x);
  [[nodiscard]] IndexSet with_falling_flipped(IndexSet set) const;
  const Mode* by_repeated_rule(double* x, const IndexSet& set);
  const Mode* in_rounds(double* x, IndexSet set);
  const Mode* search(double* x, const IndexSet& current, int trigger, bool& warm, bool& jumped);
  const Mode* try_without_jump(double* x, const IndexSet& set);
  [[nodiscard]] IndexSet with_flipped(const IndexSet& set, int port);
  const Mode* remembered(double* x, const IndexSet& wanted);
  const Mode* by_way(double* x, const IndexSet& wanted);
  const Mode* beside(double* x, const Mode& mode, const Mode* after);
  const Mode* settled(const Mode& mode, const double* x, const Mode* after);
  const Mode* from_held(double* x, const IndexSet& wanted, const Mode& held);
  const Mode* from_rcp(double* x, const IndexSet& wanted, bool& jumped);
  const Mode* jump_into(const Mode& mode, double* x);
  const Mode* from_all_modes(double* x, const IndexSet& wanted, bool& jumped);
  [[nodiscard]] IndexSet with_fallen_flipped(const IndexSet& set, const double* x);
  const Mode* from_neighbourhood(double* x, const IndexSet& wanted, int radius);
  bool impulse_allowed(const Mode& mode, const double* x, const double* after);
  const Mode* with_free_ports(double* x, const Mode& found);
  bool goes_on_one_way(const IndexSet& set);
  std::vector<const Mode*> continuations(const double* x, const Mode& chosen);
  void note_impulse();
  void begin(const double* x, const IndexSet& wanted, int trigger);
  template <class Way>
  const Mode* at_some_level(const Way& way);
  const Mode* search_at_all_levels(double* x, const IndexSet& current, int trigger, bool& warm, bool& jumped);
  const Selected& go_on_in(double* x, const Mode& mode);
  const Selected& give_up(SelectionOutcome why, const IndexSet& current);
  [[nodiscard]] const Mode* first_of(const std::vector<const Mode*>& modes) const;

  const System& system_;
  Several several_ = Several::stay;
  bool ports_are_read_ = false;  ///< by a signal or a control
  RationalProblem rational_;
  double largest_ = 0.0, largest_square_ = 0.0;  ///< ‖x‖ seen so far, and its square
  ModeStore modes_;
  std::unordered_map<IndexSet, bool, IndexSet::Hash> one_way_;  ///< whether a set without diodes has one continuation from every x
  DecayingSum decaying_;                                        ///< a guard, while the difference from the slow motion decays
  Verifier verifier_;
  std::vector<int> diode_rows_;
  std::vector<Departure> departures_;
  const Mode* departures_of_ = nullptr;
  const Mode* coordinates_of_ = nullptr;  ///< the mode in whose coordinates y_ is
  int trigger_ = -1;                      ///< port whose guard was seen to fall below zero, and the side it was on
  bool trigger_side_ = false;
  std::vector<double> y_, projected_, settled_, rate_;
  const Mode* settled_mode_ = nullptr;
  Vector left_;           ///< of decays, when a slow motion was last entered
  bool may_jump_ = true;  ///< false while testing whether the state after a jump continues without another
  Selected selected_;
  std::vector<const Mode*> jumped_into_;
  Details details_;
  Impulse impulse_;  ///< of the jump last examined
};

}  // namespace pwlsim::model
