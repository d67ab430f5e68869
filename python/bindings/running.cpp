#include <atomic>
#include <chrono>
#include <optional>

#include "convert.hpp"
#include "watched.hpp"

namespace pwlsim::python {

Options options_of(const py::dict& from) {
  Options options;
  for (const auto& [key, value] : from) {
    const auto name = key.cast<std::string>();
    if (name == "stop") options.stop = value.cast<double>();
    if (name == "step") options.step = value.cast<double>();
    if (name == "start") options.start = value.cast<double>();
    if (name == "use_initial_conditions") options.use_initial_conditions = value.cast<bool>();
    if (name == "engine") {
      const auto engine = value.cast<std::string>();
      if (engine != "auto" && engine != "exact" && engine != "sparse") throw py::value_error("engine is 'auto', 'exact' or 'sparse'");
      options.engine = engine == "exact" ? Engine::exact : engine == "sparse" ? Engine::sparse : Engine::automatic;
    }
    if (name == "reltol" && !value.is_none()) options.reltol = value.cast<double>();
    if (name == "rows_at_events") options.rows_at_events = value.cast<bool>();
    if (name == "events") options.events = value.cast<bool>();
    if (name == "evaluable") options.evaluable = value.cast<bool>();
    if (name == "run") options.run = value.cast<std::size_t>();
  }
  return options;
}

namespace {

using Clock = std::chrono::steady_clock;

/// Signals of Python reach a run: its handlers are asked now and then, and what they raise ends the run. Rows are kept.
class Interruptible {
 public:
  Interruptible(Options& options, py::object progress) : progress_(std::move(progress)) {
    options.interrupt = &flag_;
    options.progress = [this](double time) { look(time); };
  }
  /// Throws what was raised meanwhile, but for KeyboardInterrupt: that the caller makes an exception of its own of.
  [[nodiscard]] bool was_interrupted() {
    if (!raised_) return false;
    if (raised_->matches(PyExc_KeyboardInterrupt)) return true;
    throw std::move(*raised_);
  }

 private:
  static constexpr std::chrono::milliseconds pause{50};

  void look(double time) {
    const auto now = Clock::now();
    if (now - last_ < pause || flag_.load() != 0) return;
    last_ = now;
    const py::gil_scoped_acquire acquired;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (!progress_.is_none()) progress_(time);
    } catch (py::error_already_set& error) {
      raised_.emplace(std::move(error));
      flag_.store(1);
    }
  }

  py::object progress_;
  std::atomic<int> flag_ = 0;
  Clock::time_point last_ = Clock::now();
  std::optional<py::error_already_set> raised_;
};

SteadyStateOptions steady_options_of(const py::dict& from) {
  SteadyStateOptions options;
  for (const auto& [key, value] : from) {
    const auto name = key.cast<std::string>();
    if (value.is_none()) continue;
    if (name == "period") options.period = value.cast<double>();
    if (name == "multiple") options.multiple = value.cast<int>();
    if (name == "begins") options.begins = value.cast<std::string>();
    if (name == "settling_time") options.settling_time = value.cast<double>();
    if (name == "points") options.points = value.cast<int>();
    if (name == "use_initial_conditions") options.use_initial_conditions = value.cast<bool>();
  }
  return options;
}

/// (result, whether KeyboardInterrupt ended it).
py::tuple run(const Circuit& circuit, const py::dict& given, const py::object& progress) {
  Options options = options_of(given);
  Interruptible watch(options, progress);
  std::optional<Result> result;
  try {
    const py::gil_scoped_release released;
    result = circuit.run(options);
  } catch (const RunError& error) {
    (void)watch.was_interrupted();  // what Python raised stands before what came of it
    if (PyObject_IsInstance(cause_of(error).ptr(), PyExc_KeyboardInterrupt) == 1) return py::make_tuple(error.result(), true);
    throw;
  }
  return py::make_tuple(*result, watch.was_interrupted());
}

std::vector<std::pair<std::string, double>> operating_point(const Circuit& circuit, const py::dict& given) {
  const Options options = options_of(given);
  const py::gil_scoped_release released;
  return circuit.operating_point(options);
}

py::dict steady_state(const Circuit& circuit, const py::dict& what, const py::dict& given) {
  Options options = options_of(given);
  const SteadyStateOptions asked = steady_options_of(what);
  std::atomic<int> flag = 0;
  options.interrupt = &flag;
  const SteadyState state = watched(
      flag, [&] { return circuit.steady_state(asked, options); }, [] {});
  py::dict result;
  result["period"] = state.period;
  result["multiple"] = state.multiple;
  result["is_driven"] = state.is_driven;
  result["stability"] = state.stability;
  result["residual"] = state.residual;
  result["iterations"] = state.iterations;
  result["periods_simulated"] = state.periods_simulated;
  result["multipliers"] = array_of(state.multipliers);
  result["states"] = state.states;
  result["waveform"] = state.waveform;
  return result;
}

py::object loop_of(const Response& response) {
  if (!response.loop) return py::none();
  std::vector<std::pair<double, double>> crossovers, margins;
  for (const auto& each : response.loop->crossovers) crossovers.emplace_back(each.frequency, each.phase_margin);
  for (const auto& each : response.loop->gain_margins) margins.emplace_back(each.frequency, each.decibels);
  return py::make_tuple(array_of(response.loop->values), crossovers, margins);
}

py::tuple small_signals(const Circuit& circuit, const std::vector<double>& frequencies, const py::dict& what, const py::dict& around) {
  SmallSignalOptions options;
  options.from = what["from"].cast<std::string>();
  options.loop = what["loop"].cast<std::string>();
  options.harmonic = what["harmonic"].cast<int>();
  if (!what["sample"].is_none()) options.sample = what["sample"].cast<double>();
  const SteadyStateOptions steady = steady_options_of(around);
  Options running;
  std::atomic<int> flag = 0;
  running.interrupt = &flag;
  const Response response = watched(
      flag, [&] { return circuit.small_signals(frequencies, options, steady, running); }, [] {});
  py::dict values;
  for (std::size_t k = 0; k < response.signals.size(); ++k) values[response.signals[k].c_str()] = array_of(response.values[k]);
  return py::make_tuple(array_of(response.frequencies), values, loop_of(response), list_of(response.messages));
}

}  // namespace

void bind_running(py::class_<Circuit>& circuit) {
  circuit.def("run", &run)
      .def("operating_point", &operating_point)
      .def("steady_state", &steady_state)
      .def("small_signals", &small_signals)
      .def("runs", &Circuit::runs);
}

}  // namespace pwlsim::python
