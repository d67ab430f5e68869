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
  return start;
}

}  // namespace

Answer March::advance(RunState& state, double length, Observer* observer) {
  Request request;
  request.stop = length;
  request.use_initial_conditions = true;
  request.non_unique = options_.non_unique;
  request.interrupt = options_.interrupt;
  NoSink sink;
  Transient transient(model_, request, sink, selectors_, {observer, true});
  Answer answer = transient.run(start_from(state));
  state = transient.state();
  return answer;
}

Answer March::run(const RunState& from, const Request& request, RowSink& sink) {
  return Transient(model_, request, sink, selectors_, {}).run(start_from(from));
}

RunState state_of(const Start& start) { return {start.xi, start.on, {}}; }

}  // namespace pwlsim::engine
