#include "engine/exact/march.hpp"

#include "engine/exact/exact_run.hpp"

namespace pwlsim::engine {

namespace {

class NoSink : public RowSink {
 public:
  bool write(std::span<const double>, std::size_t) override { return true; }
};

}  // namespace

Answer March::advance(double until, Observer* observer, const Probes& probes) {
  Request request;
  request.probes = probes;
  request.stop = until;
  request.use_initial_conditions = true;
  request.non_unique = options_.non_unique;
  request.interrupt = options_.interrupt;
  NoSink sink;
  ExactRun transient(model_, request, sink, selectors_, {observer, true, options_.merge});
  Answer answer = transient.run(state_);
  state_ = transient.state();
  return answer;
}

Answer March::advance(RunState& state, double length, Observer* observer, const Probes& probes) {
  restart(state);
  state_.time = 0.0;
  Answer answer = advance(length, observer, probes);
  state = state_;
  state.time = 0.0;
  return answer;
}

Answer March::run(const RunState& from, const Request& request, RowSink& sink) {
  return ExactRun(model_, request, sink, selectors_, {}).run(from);
}

}  // namespace pwlsim::engine
