#include "engine/exact/march.hpp"

#include "engine/exact/transient.hpp"

namespace pwlsim::engine {

namespace {

class NoSink : public RowSink {
 public:
  bool write(std::span<const double>, std::size_t) override { return true; }
};

Start start_from(const RunState& state) {
  Start start;
  start.xi = state.xi;
  start.on = state.on;
  start.active = state.active;
  start.signals = state.signals;
  return start;
}

}  // namespace

Answer March::advance(double until, Observer* observer) {
  Request request;
  request.stop = until;
  request.use_initial_conditions = true;
  request.non_unique = options_.non_unique;
  request.interrupt = options_.interrupt;
  NoSink sink;
  Transient transient(model_, request, sink, selectors_, {observer, true, state_.time, options_.merge});
  Answer answer = transient.run(start_from(state_));
  state_ = transient.state();
  return answer;
}

Answer March::advance(RunState& state, double length, Observer* observer) {
  restart(state);
  state_.time = 0.0;
  Answer answer = advance(length, observer);
  state = state_;
  return answer;
}

Answer March::run(const RunState& from, const Request& request, RowSink& sink) {
  return Transient(model_, request, sink, selectors_, {}).run(start_from(from));
}

RunState state_of(const Start& start) { return {start.xi, start.on, {}, 0.0, start.signals}; }

}  // namespace pwlsim::engine
