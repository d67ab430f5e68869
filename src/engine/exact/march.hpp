#pragma once
/// A run that can be entered from any state, watched, and asked for the state it ends in. Its modes are kept from one stretch to the next.

#include <atomic>
#include <vector>

#include "engine/exact/observer.hpp"
#include "engine/exact/selectors.hpp"
#include "engine/exact/start.hpp"

namespace pwlsim::engine {

/// All that the future of a run depends on, beside its sources: left of t = 0, so that what happens at t = 0 is still to come.
struct RunState {
  std::vector<linalg::Vector> xi;       ///< energy coordinates of each island
  std::vector<char> on;                 ///< switches of the model
  std::vector<model::IndexSet> active;  ///< of each island, the mode's active set: where selection begins. Empty: it begins with blocking diodes.
};

class March {
 public:
  struct Options {
    NonUnique non_unique = NonUnique::error;
    const std::atomic<int>* interrupt = nullptr;  ///< nonzero: stop at once
  };
  /// `model` must outlive it.
  March(const ExactModel& model, const Options& options) : model_(model), options_(options), selectors_(model, options.non_unique) {}

  /// Runs for `length` s from t = 0, up to but without what happens at its end; `state` is where it starts and then where it ends. Instants closer than
  /// 1e-14 of `length` are one. `observer` may be null; where it ends the run the answer is complete and its time the instant's, and the state that
  /// right of the instant.
  Answer advance(RunState& state, double length, Observer* observer);
  /// An ordinary run with rows from such a state.
  Answer run(const RunState& from, const Request& request, RowSink& sink);

  [[nodiscard]] const ExactModel& model() const { return model_; }

 private:
  const ExactModel& model_;
  Options options_;
  Selectors selectors_;
};

/// Where `start` leads in.
[[nodiscard]] RunState state_of(const Start& start);

}  // namespace pwlsim::engine
