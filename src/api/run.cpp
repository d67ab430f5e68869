#include <pwlsim/pwlsim.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "api/compilation.hpp"
#include "api/controllers.hpp"
#include "api/element_value.hpp"
#include "api/finished_run.hpp"
#include "api/messages.hpp"
#include "api/result_data.hpp"
#include "base/names.hpp"

namespace pwlsim {
namespace {

void take_sweep(const circuit::Sweeps& sweeps, std::size_t run, Result::Data& data) {
  const std::vector<double> point = sweeps.point(run);
  for (std::size_t k = 0; k < point.size(); ++k) data.stepped.emplace_back(sweeps.list[k].name, point[k]);
}

void check_run(std::size_t run, const circuit::Sweeps& sweeps) {
  const std::size_t runs = std::max<std::size_t>(sweeps.runs(), 1);
  if (run >= runs) throw api::error("E-range", fmt::format("there is no run number {}; try 0 to {}", run, runs - 1));
}

/// Throws a RunError in which the controller's exception is nested.
[[noreturn]] void end_by_controller(const std::exception_ptr& thrown, const std::shared_ptr<Result::Data>& data) {
  std::erase_if(data->messages, [](const Message& message) { return message.id == "E-interrupted"; });
  data->messages.push_back(api::message_of({Severity::error, "E-controller", {}, api::sentence_of(thrown, data->end)}));
  try {
    std::rethrow_exception(thrown);
  } catch (...) {
    std::throw_with_nested(RunError(Result(data)));
  }
}

/// Tells which cards of the deck a run leaves to other functions. It starts on the orbit of `.pss`, unless controllers forbid that.
void tell_cards_left(const circuit::Compiled& compiled, bool starts_on_orbit, Result::Data& data) {
  const circuit::Analyses& analyses = compiled.analyses;
  std::string left;
  const auto add = [&](bool is_there, std::string_view card) {
    if (is_there) left += fmt::format("{}{}", left.empty() ? "" : ", ", card);
  };
  const bool measures_orbit = !compiled.orbit_measurements.list.empty();
  add(analyses.steady_state && (!starts_on_orbit || measures_orbit), starts_on_orbit ? ".meas pss (steady_state)" : ".pss (steady_state)");
  add(analyses.small_signal.has_value(), ".ac (small_signals, in Python ac)");
  add(analyses.sensitivities.has_value(), ".sens (gradient)");
  if (!left.empty())
    data.messages.push_back(
        api::message_of({Severity::note,
                         "N-transient-only",
                         {},
                         fmt::format("run gives what .tran asks for and leaves out cards that have their own function: {}", left)}));
}

/// Instances are named "X1.R1"; users write "X1:R1", as in the names of signals.
std::string with_colons(std::string name) {
  std::replace(name.begin(), name.end(), '.', ':');
  return name;
}

}  // namespace

const char* version() { return PWLSIM_VERSION; }

Result Circuit::run(const Options& options) const {
  Compilation compilation(*this, options, {.analysis_required = true});
  if (!compilation.compiled().analyses.transient)
    throw api::error("E-no-transient", "the circuit has no .tran; try Options::stop, or Circuit::operating_point");
  check_run(options.run, compilation.compiled().analyses.sweeps);
  analysis::PreparedEngine engine = compilation.engine(options);
  const auto data = api::begin_result(compilation, engine);
  take_sweep(compilation.compiled().analyses.sweeps, options.run, *data);
  tell_cards_left(compilation.compiled(), controllers_.empty(), *data);
  if (!controllers_.empty() && !engine.has_modes) throw api::error("E-controller", "controllers need the exact engine; try engine exact");
  if (controllers_.empty()) api::start_on_orbit(compilation.compiled(), engine, options, data);
  const auto controllers =
      controllers_.empty() ? nullptr : std::make_shared<api::Controllers>(controllers_, compilation.compiled().network);
  const auto kept = std::make_shared<const KeptRun>(KeptRun{std::make_shared<const circuit::Compiled>(compilation.take()),
                                                            std::move(engine.simulate), compilation.departures(), controllers});
  const bool is_done = api::run_into(*data, kept, options, controllers.get());
  if (controllers && controllers->thrown()) end_by_controller(controllers->thrown(), data);
  if (!is_done) throw RunError(Result(data));
  return Result(data);
}

std::vector<std::pair<std::string, double>> Circuit::operating_point(const Options& options) const {
  Compilation compilation(*this, options, {});
  const analysis::PreparedEngine engine = compilation.engine(options);
  const auto data = api::begin_result(compilation, engine);
  const engine::OperatingPoint point = engine.operating_point();
  api::take_answer_of(point.answer, *data);
  if (point.answer.outcome != engine::Outcome::completed) {
    data->messages.push_back(api::message_of({Severity::error, point.answer.id, {}, point.answer.message}));
    throw RunError(Result(data));
  }
  std::vector<std::pair<std::string, double>> values;
  for (std::size_t k = 0; k < data->signals.size(); ++k) values.emplace_back(data->signals[k], point.values[k]);
  return values;
}

std::size_t Circuit::runs() const {
  const Compilation compilation(*this, {}, {});
  return std::max<std::size_t>(compilation.compiled().analyses.sweeps.runs(), 1);
}

Circuit& Circuit::set_value(std::string_view element, const Waveform& value) {
  const auto given = std::find_if(values_.begin(), values_.end(), [&](const auto& each) { return same_name(each.first, element); });
  if (given == values_.end())
    values_.emplace_back(element, value.text());
  else
    given->second = value.text();
  return *this;
}

double Circuit::value(std::string_view element) const {
  const Compilation compilation(*this, {}, {.keeps_circuit = true});
  const std::string name = with_colons(std::string(element));
  for (const elements::Instance& instance : compilation.compiled().circuit->instances) {
    if (!same_name(with_colons(instance.name), name)) continue;
    if (const auto value = api::value_of(instance)) return *value;
    throw api::error("E-no-value", fmt::format("{} has no single number as its value", element));
  }
  throw api::error("E-unknown-element", fmt::format("the circuit has no element '{}'", element));
}

std::vector<std::string> Circuit::elements() const {
  const Compilation compilation(*this, {}, {.keeps_circuit = true});
  std::vector<std::string> names;
  for (const elements::Instance& instance : compilation.compiled().circuit->instances) names.push_back(with_colons(instance.name));
  return names;
}

}  // namespace pwlsim
