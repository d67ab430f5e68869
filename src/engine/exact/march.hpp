#pragma once
/// A run that can start from any state, be observed, and return the state in which it ends. It keeps its modes from one call to the next. Two runs,
/// the second from where the first ends, at an instant, give what one run gives, to the last bit.

#include <atomic>

#include "engine/exact/observer.hpp"
#include "engine/exact/run_state.hpp"
#include "engine/exact/selectors.hpp"

namespace pwlsim::engine {

class March {
 public:
  struct Options {
    NonUnique non_unique = NonUnique::error;
    const std::atomic<int>* interrupt = nullptr;  ///< nonzero: stop at once
    double merge = 0.0;                           ///< s: instants closer than this are one; 0: 1e-14 of the end time of a run
  };
  /// `model` must outlive it.
  March(const ExactModel& model, const Options& options) : model_(model), options_(options), selectors_(model, options.non_unique) {}

  /// The next run starts from here.
  void restart(const RunState& state) { state_ = state; }
  /// Runs up to but excluding the instant `until`, s. `observer` may be null; if it ends the run, the answer is complete, its time is that of the
  /// instant, and the state is that after the instant. `probes` receive the pieces, too.
  Answer advance(double until, Observer* observer, const Probes& probes = {});
  /// The state at the end of the last run, which is the start of the next one.
  [[nodiscard]] const RunState& state() const { return state_; }

  /// The same for `length` s with sources as from t = 0 on, whatever the state's time; `state` is the start and then the end,
  /// which is at t = 0 of the next such run.
  Answer advance(RunState& state, double length, Observer* observer, const Probes& probes = {});
  /// An ordinary run with rows from such a state.
  Answer run(const RunState& from, const Request& request, RowSink& sink);

  [[nodiscard]] const ExactModel& model() const { return model_; }

 private:
  const ExactModel& model_;
  Options options_;
  Selectors selectors_;
  RunState state_;
};

}  // namespace pwlsim::engine
