#include <pwlsim/sweep.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "analysis/stepped_sources.hpp"
#include "api/compilation.hpp"
#include "api/element_value.hpp"
#include "api/finished_run.hpp"
#include "api/messages.hpp"

namespace pwlsim {

struct Sweep::Data {
  Data(const Circuit& circuit, const Options& given) : options(given), compilation(circuit, given, {.analysis_required = true}) {}

  Options options;
  Compilation compilation;  ///< with the values of the deck
  std::vector<std::string> names;
  circuit::Sweeps stepped;  ///< of `.step`
  std::optional<analysis::SteppedSources> sources;
};

namespace {

/// Whether what changes may be sources and nothing else: parameters act wherever they are used.
bool may_be_sources(const Sweep::Data& data) {
  const std::vector<circuit::Sweep>& cards = data.compilation.compiled().analyses.sweeps.list;
  if (!cards.empty())
    return !data.stepped.list.empty() &&
           std::all_of(cards.begin(), cards.end(), [](const circuit::Sweep& card) { return card.is_source(); });
  const auto is_parameter = [&](const std::string& name) { return api::has_parameter(data.compilation.deck().cards, name); };
  return std::none_of(data.names.begin(), data.names.end(), is_parameter);
}

/// Where only constant sources change, the model is kept from run to run.
void look_for_sources(Sweep::Data& data) {
  const Compilation& read = data.compilation;
  if (read.has_controllers()) throw api::error("E-controller", "a circuit with controllers has no sweep; try a loop over Circuit::run");
  if (!may_be_sources(data) || read.compiled().analyses.steady_state) return;
  Diagnostics diagnostics;
  SourceStore sources = read.sources();
  auto compiled = circuit::compile(read.deck(), sources, diagnostics, {.measure = true, .held = data.names});
  if (!compiled || diagnostics.has_errors()) return;
  data.sources = analysis::SteppedSources::make(std::move(*compiled), data.names.size(), api::choice_of(data.options.engine));
}

std::vector<GivenValue> given_values(const std::vector<std::string>& names, const std::vector<double>& values) {
  if (names.size() != values.size())
    throw api::error("E-argument-count", fmt::format("a run of a sweep of {} names was given {} values", names.size(), values.size()));
  std::vector<GivenValue> given;
  for (std::size_t k = 0; k < names.size(); ++k) given.push_back({names[k], values[k]});
  return given;
}

}  // namespace

Sweep::Sweep(const Circuit& circuit, std::vector<std::string> names, const Options& options) {
  auto data = std::make_shared<Data>(circuit, options);
  data->names = std::move(names);
  look_for_sources(*data);
  data_ = std::move(data);
}

Sweep::Sweep(const Circuit& circuit, const Options& options) {
  auto data = std::make_shared<Data>(circuit, options);
  data->stepped = data->compilation.compiled().analyses.sweeps;
  for (const circuit::Sweep& each : data->stepped.list) data->names.push_back(each.name);
  look_for_sources(*data);
  data_ = std::move(data);
}

const std::vector<std::string>& Sweep::names() const { return data_->names; }
std::vector<std::string> Sweep::measurements() const {
  std::vector<std::string> names;
  for (const auto& each : data_->compilation.compiled().measurements.list) names.push_back(each.name);
  return names;
}

std::size_t Sweep::runs() const { return data_->stepped.runs(); }
std::vector<double> Sweep::point(std::size_t run) const { return data_->stepped.point(run); }

Result Sweep::run(const std::vector<double>& given, std::size_t number, const std::atomic<int>* interrupt) const {
  const bool is_stepped = !data_->stepped.list.empty();
  const std::vector<double> values = is_stepped ? point(number) : given;
  Options options = data_->options;
  options.run = number;
  options.interrupt = interrupt;
  const std::vector<GivenValue> list = given_values(data_->names, values);
  std::shared_ptr<Result::Data> result;
  std::shared_ptr<const KeptRun> kept;
  if (data_->sources) {
    kept = std::make_shared<const KeptRun>(KeptRun{data_->sources->compiled(), data_->sources->simulate(values), {}});
    result = api::begin_result(*kept->compiled, data_->compilation.messages(), "exact");
  } else {
    Compilation compilation(data_->compilation, options, is_stepped ? std::vector<GivenValue>{} : list);
    analysis::PreparedEngine engine = compilation.engine(options);
    result = api::begin_result(compilation, engine);
    api::start_on_orbit(compilation.compiled(), engine, options, result);
    kept = std::make_shared<const KeptRun>(
        KeptRun{std::make_shared<const circuit::Compiled>(compilation.take()), std::move(engine.simulate), {}});
  }
  for (const GivenValue& each : list) result->stepped.emplace_back(each);
  if (!api::run_into(*result, kept, options, nullptr)) throw RunError(Result(result));
  return Result(result);
}

namespace {

SweptRun run_one(const Sweep& sweep, const std::vector<double>& point, std::size_t number, const std::atomic<int>* interrupt) {
  SweptRun run;
  try {
    const Result result = sweep.run(point, number, interrupt);
    for (const Measurement& each : result.measurements())
      run.measurements.push_back(each.failure.empty() ? each.value : std::numeric_limits<double>::quiet_NaN());
    run.done = result.completed();
    if (!run.done) run.id = "E-interrupted";
  } catch (const Error& error) {
    run.id = error.id();
    for (const Message& message : error.messages())
      if (message.kind == Message::Kind::error && message.id == error.id() && run.message.empty()) run.message = message.text;
  }
  return run;
}

}  // namespace

void run_all(const Sweep& sweep, const std::vector<std::vector<double>>& points, std::size_t jobs,
             const std::function<void(std::size_t, const SweptRun&)>& take, const std::atomic<int>* interrupt) {
  std::atomic<std::size_t> begun = 0;
  std::mutex mutex;
  const auto work = [&] {
    for (std::size_t number = begun++; number < points.size(); number = begun++) {
      if (interrupt != nullptr && interrupt->load() != 0) return;
      const SweptRun run = run_one(sweep, points[number], number, interrupt);
      if (run.id == "E-interrupted") return;
      const std::scoped_lock lock(mutex);
      take(number, run);
    }
  };
  const std::size_t wanted = jobs != 0 ? jobs : std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::thread> threads;
  for (std::size_t k = 1; k < std::min(wanted, points.size()); ++k) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
}

}  // namespace pwlsim
