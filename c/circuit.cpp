#include <algorithm>
#include <memory>
#include <stdexcept>
#include <utility>

#include "handles.hpp"

namespace pwlsim::c {
namespace {

struct Failure {
  std::string id, text;
  std::vector<Message> messages;
};
thread_local Failure last_failure;

/// Compiles it; throws Error.
int check(const Circuit& circuit) {
  (void)circuit.runs();
  return PWLSIM_OK;
}

int parse(Circuit circuit, pwlsim_circuit** place) {
  auto made = std::make_unique<pwlsim_circuit>(pwlsim_circuit{std::move(circuit)});
  *place = made.release();
  return check((*place)->circuit);
}

std::vector<std::string> strings_of(const char* const* list, std::size_t count) {
  std::vector<std::string> strings;
  for (std::size_t k = 0; k < count; ++k) {
    if (list[k] == nullptr) throw std::invalid_argument("a name is null");
    strings.emplace_back(list[k]);
  }
  return strings;
}

}  // namespace

int fail(int status, const char* text) noexcept {
  try {
    last_failure = {{}, text, {}};
  } catch (...) {
    last_failure = {};
  }
  return status;
}

int fail(int status, const Error& error) noexcept {
  try {
    last_failure = {error.id(), error.what(), error.messages()};
  } catch (...) {
    last_failure = {};
  }
  return status;
}

pwlsim_message message_of(const Message& message) noexcept {
  return {static_cast<int>(message.kind), message.id.c_str(), message.text.c_str(), message.full.c_str()};
}

}  // namespace pwlsim::c

using namespace pwlsim::c;

const char* pwlsim_version(void) { return pwlsim::version(); }
const char* pwlsim_last_error(void) { return last_failure.text.c_str(); }
const char* pwlsim_last_error_id(void) { return last_failure.id.c_str(); }
size_t pwlsim_error_messages(void) { return last_failure.messages.size(); }

int pwlsim_error_message(size_t number, pwlsim_message* message) {
  if (message == nullptr || number >= last_failure.messages.size()) return PWLSIM_ARGUMENT;  // the failure stays
  *message = message_of(last_failure.messages[number]);
  return PWLSIM_OK;
}

int pwlsim_parse_text(const char* deck, pwlsim_circuit** circuit) {
  if (deck == nullptr || circuit == nullptr) return bad_argument("pwlsim_parse_text: a pointer is null");
  *circuit = nullptr;
  return guarded([&] { return parse(pwlsim::Circuit::from_text(deck), circuit); });
}

int pwlsim_parse_file(const char* path, pwlsim_circuit** circuit) {
  if (path == nullptr || circuit == nullptr) return bad_argument("pwlsim_parse_file: a pointer is null");
  *circuit = nullptr;
  return guarded([&] { return parse(pwlsim::Circuit::from_file(path), circuit); });
}

int pwlsim_circuit_copy(const pwlsim_circuit* circuit, pwlsim_circuit** copy) {
  if (circuit == nullptr || copy == nullptr) return bad_argument("pwlsim_circuit_copy: a pointer is null");
  *copy = nullptr;
  return guarded([&] {
    *copy = std::make_unique<pwlsim_circuit>(pwlsim_circuit{circuit->circuit}).release();
    return PWLSIM_OK;
  });
}

void pwlsim_circuit_free(pwlsim_circuit* circuit) { delete circuit; }

int pwlsim_add_cards(pwlsim_circuit* circuit, const char* lines) {
  if (circuit == nullptr || lines == nullptr) return bad_argument("pwlsim_add_cards: a pointer is null");
  return guarded([&] {
    circuit->circuit.cards(lines);
    return PWLSIM_OK;
  });
}

int pwlsim_set_value(pwlsim_circuit* circuit, const char* element, double value) {
  if (circuit == nullptr || element == nullptr) return bad_argument("pwlsim_set_value: a pointer is null");
  return guarded([&] {
    circuit->circuit.set_value(element, value);
    return PWLSIM_OK;
  });
}

int pwlsim_set_text(pwlsim_circuit* circuit, const char* element, const char* value) {
  if (circuit == nullptr || element == nullptr || value == nullptr) return bad_argument("pwlsim_set_text: a pointer is null");
  return guarded([&] {
    circuit->circuit.set_value(element, value);
    return PWLSIM_OK;
  });
}

int pwlsim_set_parameter(pwlsim_circuit* circuit, const char* name, double value) {
  if (circuit == nullptr || name == nullptr) return bad_argument("pwlsim_set_parameter: a pointer is null");
  return guarded([&] {
    circuit->circuit.parameter(name, value);
    return PWLSIM_OK;
  });
}

int pwlsim_get_value(const pwlsim_circuit* circuit, const char* element, double* value) {
  if (circuit == nullptr || element == nullptr || value == nullptr) return bad_argument("pwlsim_get_value: a pointer is null");
  return guarded([&] {
    *value = circuit->circuit.value(element);
    return PWLSIM_OK;
  });
}

int pwlsim_step_runs(const pwlsim_circuit* circuit, size_t* runs) {
  if (circuit == nullptr || runs == nullptr) return bad_argument("pwlsim_step_runs: a pointer is null");
  return guarded([&] {
    *runs = circuit->circuit.runs();
    return PWLSIM_OK;
  });
}

int pwlsim_controller(pwlsim_circuit* circuit, const char* const* inputs, size_t input_count, const char* const* outputs,
                      size_t output_count, double every, double delay, const double* initial, pwlsim_function function, void* data) {
  const bool is_whole = circuit != nullptr && function != nullptr && (inputs != nullptr || input_count == 0) && outputs != nullptr;
  if (!is_whole) return bad_argument("pwlsim_controller: a pointer is null");
  return guarded([&] {
    pwlsim::Controller controller{strings_of(inputs, input_count), strings_of(outputs, output_count), every, delay};
    if (initial != nullptr) controller.initial.assign(initial, initial + output_count);
    controller.function = [function, data](double time, const std::vector<double>& seen, std::vector<double>& set) {
      const int answer = function(time, seen.data(), set.data(), data);
      if (answer != 0) throw std::runtime_error("it returned " + std::to_string(answer));
    };
    circuit->circuit.controller(std::move(controller));
    return PWLSIM_OK;
  });
}
