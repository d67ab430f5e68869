#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>

#include "handles.hpp"

pwlsim_result::pwlsim_result(pwlsim::Result of) : result(std::move(of)) {
  for (const pwlsim::Event& event : result.events()) {
    Names& each = names.emplace_back();
    for (const std::string& name : event.turned_on) each.on.push_back(name.c_str());
    for (const std::string& name : event.turned_off) each.off.push_back(name.c_str());
  }
}

namespace pwlsim::c {
namespace {

/// The fields that the caller knows, zeros in the others.
pwlsim_options known_part(const pwlsim_options* given) {
  pwlsim_options options{};
  if (given != nullptr) std::memcpy(&options, given, std::min(given->size, sizeof options));
  return options;
}

/// The caller's number as the library reads it.
const std::atomic<int>* flag_of(const int* interrupt) {
  static_assert(sizeof(std::atomic<int>) == sizeof(int) && std::atomic<int>::is_always_lock_free);
  return reinterpret_cast<const std::atomic<int>*>(interrupt);
}

Options options_of(const pwlsim_options& from) {
  Options options;
  options.stop = from.stop;
  options.step = from.step;
  options.start = from.start;
  options.use_initial_conditions = from.use_initial_conditions != 0;
  options.engine = from.engine == PWLSIM_EXACT ? Engine::exact : from.engine == PWLSIM_SPARSE ? Engine::sparse : Engine::automatic;
  if (from.reltol != 0.0) options.reltol = from.reltol;
  options.rows_at_events = from.rows_at_events != 0;
  options.events = from.without_events == 0;
  options.evaluable = from.without_model == 0;
  options.run = from.run;
  options.interrupt = flag_of(from.interrupt);
  return options;
}

int run(const Circuit& circuit, const Options& options, pwlsim_result** place) {
  try {
    *place = std::make_unique<pwlsim_result>(circuit.run(options)).release();
  } catch (const RunError& error) {
    *place = std::make_unique<pwlsim_result>(error.result()).release();
    return fail(PWLSIM_RUN_FAILED, error);
  }
  const Result& result = (*place)->result;
  return result.completed() ? PWLSIM_OK : fail(PWLSIM_INTERRUPTED, Error(result.messages()));
}

}  // namespace
}  // namespace pwlsim::c

using namespace pwlsim::c;

int pwlsim_run(const pwlsim_circuit* circuit, const pwlsim_options* options, pwlsim_result** result) {
  if (circuit == nullptr || result == nullptr) return bad_argument("pwlsim_run: a pointer is null");
  *result = nullptr;
  const pwlsim_options given = known_part(options);
  if (options != nullptr && options->size == 0) return bad_argument("pwlsim_run: options->size is 0; set it to sizeof(pwlsim_options)");
  if (given.engine < PWLSIM_AUTOMATIC || given.engine > PWLSIM_SPARSE) return bad_argument("pwlsim_run: options->engine is 0, 1 or 2");
  return guarded([&] { return run(circuit->circuit, options_of(given), result); });
}

void pwlsim_result_free(pwlsim_result* result) { delete result; }

int pwlsim_completed(const pwlsim_result* result) { return result != nullptr && result->result.completed() ? 1 : 0; }
double pwlsim_end(const pwlsim_result* result) { return result == nullptr ? 0.0 : result->result.end(); }
size_t pwlsim_rows(const pwlsim_result* result) { return result == nullptr ? 0 : result->result.time().size(); }
const double* pwlsim_time(const pwlsim_result* result) { return result == nullptr ? nullptr : result->result.time().data(); }
size_t pwlsim_signals(const pwlsim_result* result) { return result == nullptr ? 0 : result->result.signals().size(); }

const char* pwlsim_signal_name(const pwlsim_result* result, size_t number) {
  return number < pwlsim_signals(result) ? result->result.signals()[number].c_str() : nullptr;
}

const double* pwlsim_signal(const pwlsim_result* result, const char* name) {
  const double* values = nullptr;
  if (result == nullptr || name == nullptr)
    (void)bad_argument("pwlsim_signal: a pointer is null");
  else
    (void)guarded([&] {
      values = result->result.signal(name).data();
      return PWLSIM_OK;
    });
  return values;
}

int pwlsim_at(const pwlsim_result* result, const char* name, const double* times, size_t count, double* values) {
  if (result == nullptr || name == nullptr || (count != 0 && (times == nullptr || values == nullptr)))
    return bad_argument("pwlsim_at: a pointer is null");
  return guarded([&] {
    const std::vector<double> found = result->result.at(name, {times, times + count});
    std::copy(found.begin(), found.end(), values);
    return PWLSIM_OK;
  });
}

size_t pwlsim_events(const pwlsim_result* result) { return result == nullptr ? 0 : result->result.events().size(); }

int pwlsim_get_event(const pwlsim_result* result, size_t number, pwlsim_event* event) {
  if (event == nullptr || number >= pwlsim_events(result))
    return bad_argument("pwlsim_get_event: a pointer is null, or there is no event of that number");
  const pwlsim::Event& from = result->result.events()[number];
  const pwlsim_result::Names& names = result->names[number];
  *event = {from.time,       from.source_edge ? 1 : 0, from.mode_change ? 1 : 0, from.jump ? 1 : 0,
            names.on.size(), names.off.size(),         names.on.data(),          names.off.data()};
  return PWLSIM_OK;
}

size_t pwlsim_measurements(const pwlsim_result* result) { return result == nullptr ? 0 : result->result.measurements().size(); }

int pwlsim_get_measurement(const pwlsim_result* result, size_t number, pwlsim_measurement* measurement) {
  if (measurement == nullptr || number >= pwlsim_measurements(result))
    return bad_argument("pwlsim_get_measurement: a pointer is null, or there is no measurement of that number");
  const pwlsim::Measurement& from = result->result.measurements()[number];
  const double value = from.failure.empty() ? from.value : std::numeric_limits<double>::quiet_NaN();
  *measurement = {from.name.c_str(), value, from.unit.c_str(), from.failure.c_str()};
  return PWLSIM_OK;
}

int pwlsim_measure(const pwlsim_result* result, const char* name, double* value) {
  if (result == nullptr || name == nullptr || value == nullptr) return bad_argument("pwlsim_measure: a pointer is null");
  return guarded([&] {
    *value = result->result.measurement(name);
    return PWLSIM_OK;
  });
}

int pwlsim_get_certificate(const pwlsim_result* result, pwlsim_certificate* certificate) {
  if (result == nullptr || certificate == nullptr) return bad_argument("pwlsim_get_certificate: a pointer is null");
  const pwlsim::Certificate& from = result->result.certificate();
  *certificate = {from.complementarity, from.kcl_kvl, from.energy, from.passive ? (*from.passive ? 1 : 0) : -1};
  return PWLSIM_OK;
}

size_t pwlsim_result_messages(const pwlsim_result* result) { return result == nullptr ? 0 : result->result.messages().size(); }

int pwlsim_result_message(const pwlsim_result* result, size_t number, pwlsim_message* message) {
  if (message == nullptr || number >= pwlsim_result_messages(result))
    return bad_argument("pwlsim_result_message: a pointer is null, or there is no message of that number");
  *message = message_of(result->result.messages()[number]);
  return PWLSIM_OK;
}

int pwlsim_report(const pwlsim_result* result, char** page) {
  if (result == nullptr || page == nullptr) return bad_argument("pwlsim_report: a pointer is null");
  *page = nullptr;
  return guarded([&] {
    const std::string text = result->result.report();
    *page = static_cast<char*>(std::malloc(text.size() + 1));
    if (*page == nullptr) throw std::bad_alloc();
    std::memcpy(*page, text.c_str(), text.size() + 1);
    return PWLSIM_OK;
  });
}

void pwlsim_text_free(char* text) { std::free(text); }
