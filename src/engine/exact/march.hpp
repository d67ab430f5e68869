#pragma once
/// A run that can start from any state, be observed, and return the state in which it ends. It keeps its modes from one call to the next.

#include <atomic>

#include "engine/exact/observer.hpp"
#include "engine/exact/run_state.hpp"
#include "engine/exact/selectors.hpp"
#include "engine/exact/start.hpp"

namespace pwlsim::engine {

class March {
 public:
  struct Options {
    NonUnique non_unique = NonUnique::error;
    const std::atomic<int>* interrupt = nullptr;  ///< nonzero: stop at once
  };
  /// `model` must outlive it.
  March(const ExactModel& model, const Options& options) : model_(model), options_(options), selectors_(model, options.non_unique) {}

  /// Runs for `length` s from t = 0, up to but excluding the instant at its end; `state` is the start and then the end. Instants closer than
  /// 1e-14 of `length` are one. `observer` may be null; if it ends the run, the answer is complete, its time is that of the instant, and the state is
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

/// The state in which `start` begins a run.
[[nodiscard]] RunState state_of(const Start& start);

}  // namespace pwlsim::engine
