/* The C interface: statuses, messages, arrays, controllers, interruption, threads. Ends with 0 where all checks hold. */

#include <math.h>
#include <pthread.h>
#include <pwlsim.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures;
#define CHECK(what) ((what) ? (void)0 : (void)(++failures, fprintf(stderr, "%s:%d: not so: %s; %s\n", __FILE__, __LINE__, #what, pwlsim_last_error())))

static const char charging[] = "rc\nV1 in 0 10\nR1 in out 1k\nC1 out 0 1u ic=0\n.save v(out)\n.meas tran top MAX v(out)\n.meas tran never WHEN v(out)=99\n.tran 1m 5m uic\n";

/* v = 10 (1 - exp(-t/RC)) */
static void test_arrays(void) {
  pwlsim_circuit* circuit = NULL;
  pwlsim_result* result = NULL;
  pwlsim_certificate certificate;
  pwlsim_measurement measurement;
  double value = 0, times[2] = {3.3e-3, 1e-7}, values[2];
  size_t k;
  char* page = NULL;
  CHECK(pwlsim_parse_text(charging, &circuit) == PWLSIM_OK);
  CHECK(pwlsim_get_value(circuit, "r1", &value) == PWLSIM_OK && value == 1e3);
  CHECK(pwlsim_step_runs(circuit, &k) == PWLSIM_OK && k == 1);
  CHECK(pwlsim_run(circuit, NULL, &result) == PWLSIM_OK);
  CHECK(pwlsim_completed(result) == 1 && pwlsim_end(result) == 5e-3 && pwlsim_rows(result) == 6 && pwlsim_signals(result) == 1);
  CHECK(strcmp(pwlsim_signal_name(result, 0), "v(out)") == 0 && pwlsim_signal_name(result, 1) == NULL);
  for (k = 0; k < 6; ++k) CHECK(fabs(pwlsim_signal(result, "V(OUT)")[k] + 10 * expm1(-pwlsim_time(result)[k] / 1e-3)) < 1e-12);
  CHECK(pwlsim_at(result, "v(out)", times, 2, values) == PWLSIM_OK);
  for (k = 0; k < 2; ++k) CHECK(fabs(values[k] + 10 * expm1(-times[k] / 1e-3)) < 1e-12);
  CHECK(pwlsim_measurements(result) == 2 && pwlsim_measure(result, "TOP", &value) == PWLSIM_OK && fabs(value + 10 * expm1(-5)) < 1e-12);
  CHECK(pwlsim_get_measurement(result, 1, &measurement) == PWLSIM_OK && isnan(measurement.value) && measurement.failure[0] != 0);
  CHECK(pwlsim_measure(result, "never", &value) == PWLSIM_INVALID && strcmp(pwlsim_last_error_id(), "W-measurement-failed") == 0);
  CHECK(pwlsim_get_certificate(result, &certificate) == PWLSIM_OK && certificate.passive == 1 && certificate.kcl_kvl < 1e-12);
  CHECK(pwlsim_report(result, &page) == PWLSIM_OK && strstr(page, "v(out)") != NULL);
  pwlsim_text_free(page);
  CHECK(pwlsim_signal(result, "v(no)") == NULL && strcmp(pwlsim_last_error_id(), "E-unknown-signal") == 0);
  times[0] = 6e-3;
  CHECK(pwlsim_at(result, "v(out)", times, 1, values) == PWLSIM_INVALID && strcmp(pwlsim_last_error_id(), "E-range") == 0);
  pwlsim_result_free(result);
  pwlsim_circuit_free(circuit);
}

static void test_failures(void) {
  pwlsim_circuit* circuit = NULL;
  pwlsim_circuit* other = NULL;
  pwlsim_result* result = NULL;
  pwlsim_message message;
  pwlsim_options options = {0};
  double value;
  CHECK(pwlsim_parse_text("wrong\nV1 a 0 1\nR1 a 0 {q}\nD1 a 0 fsat\n.model fast D\n.tran 1 2\n", &circuit) == PWLSIM_INVALID);
  CHECK(circuit != NULL && pwlsim_error_messages() == 2 && pwlsim_error_message(1, &message) == PWLSIM_OK && message.kind == PWLSIM_ERROR);
  CHECK(pwlsim_error_message(2, &message) == PWLSIM_ARGUMENT && strstr(pwlsim_last_error(), "try 'fast'") != NULL);
  CHECK(pwlsim_run(circuit, NULL, &result) == PWLSIM_INVALID && result == NULL);
  CHECK(pwlsim_add_cards(circuit, ".param q=1\n.model fsat D\nR2 a 0 1") == PWLSIM_OK && pwlsim_circuit_copy(circuit, &other) == PWLSIM_OK);
  CHECK(pwlsim_get_value(other, "R1", &value) == PWLSIM_OK && value == 1);
  CHECK(pwlsim_get_value(other, "R9", &value) == PWLSIM_INVALID && strcmp(pwlsim_last_error_id(), "E-unknown-element") == 0);
  pwlsim_circuit_free(circuit);
  pwlsim_circuit_free(other);

  CHECK(pwlsim_parse_file("no such file.net", &circuit) == PWLSIM_INVALID && strncmp(pwlsim_last_error_id(), "E-", 2) == 0);
  pwlsim_circuit_free(circuit);
  CHECK(pwlsim_parse_text(NULL, &circuit) == PWLSIM_ARGUMENT && pwlsim_run(NULL, NULL, &result) == PWLSIM_ARGUMENT);

  /* A source of current into a diode that blocks: no solution once it turns round. */
  CHECK(pwlsim_parse_text("blocked\nI1 0 a PWL(0 1 1m 1 1m -1)\nD1 a 0 d\n.model d D\n.tran 0.1m 2m\n", &circuit) == PWLSIM_OK);
  CHECK(pwlsim_run(circuit, NULL, &result) == PWLSIM_RUN_FAILED && strcmp(pwlsim_last_error_id(), "E-no-solution") == 0);
  CHECK(result != NULL && !pwlsim_completed(result) && fabs(pwlsim_end(result) - 1e-3) < 1e-12 && pwlsim_signal(result, "i(D1)")[3] == 1);
  CHECK(pwlsim_result_messages(result) >= 1);
  pwlsim_result_free(result);
  CHECK(pwlsim_run(circuit, &options, &result) == PWLSIM_ARGUMENT && result == NULL); /* its size is 0 */
  options.size = sizeof options;
  options.engine = 9;
  CHECK(pwlsim_run(circuit, &options, &result) == PWLSIM_ARGUMENT);
  pwlsim_circuit_free(circuit);
  pwlsim_circuit_free(NULL);
  pwlsim_result_free(NULL);
}

static void test_options(void) {
  const int stop_now = 1;
  pwlsim_circuit* circuit = NULL;
  pwlsim_result* result = NULL;
  pwlsim_event event;
  pwlsim_options options = {0};
  options.size = sizeof options;
  options.stop = 40e-3;
  options.step = 1e-3;
  options.without_model = 1;
  CHECK(pwlsim_parse_text("half\nV1 a 0 SIN(0 10 50)\nX1 a b sub\n.subckt sub a b\nD1 a b d\n.ends\n.model d D\nR1 b 0 1\n", &circuit) == PWLSIM_OK);
  CHECK(pwlsim_run(circuit, &options, &result) == PWLSIM_OK && pwlsim_rows(result) == 41);
  CHECK(pwlsim_get_event(result, 0, &event) == PWLSIM_OK && fabs(event.time - 0.01) < 1e-14 && event.mode_change && !event.jump);
  CHECK(event.on_count == 0 && event.off_count == 1 && strcmp(event.turned_off[0], "X1.D1") == 0);
  CHECK(pwlsim_at(result, "v(b)", &event.time, 1, &event.time) == PWLSIM_INVALID && strcmp(pwlsim_last_error_id(), "E-not-kept") == 0);
  pwlsim_result_free(result);
  options.stop = 1e5;
  options.interrupt = &stop_now;
  CHECK(pwlsim_run(circuit, &options, &result) == PWLSIM_INTERRUPTED && result != NULL && pwlsim_end(result) < 1e5);
  pwlsim_result_free(result);
  pwlsim_circuit_free(circuit);
}

struct counter {
  int calls, fails_at;
};

static int count(double time, const double* inputs, double* outputs, void* data) {
  struct counter* const counter = data;
  outputs[0] = inputs[0] + 1;
  return ++counter->calls == counter->fails_at ? 7 : (time < 0);
}

/* v(a) rises by 1 V at each sample; what the function answers but 0 ends the run. */
static void test_controllers(void) {
  const char *inputs[] = {"v(a)"}, *outputs[] = {"a"};
  struct counter counter = {0, 0};
  pwlsim_circuit* circuit = NULL;
  pwlsim_result* result = NULL;
  CHECK(pwlsim_parse_text("staircase\nR1 a 0 1\n.save v(a)\n.tran 0.5m 3m\n", &circuit) == PWLSIM_OK);
  CHECK(pwlsim_controller(circuit, inputs, 1, outputs, 1, 0, 0, NULL, count, &counter) == PWLSIM_INVALID);
  CHECK(strcmp(pwlsim_last_error_id(), "E-controller") == 0);
  CHECK(pwlsim_controller(circuit, inputs, 1, outputs, 1, 1e-3, 0, NULL, NULL, NULL) == PWLSIM_ARGUMENT);
  CHECK(pwlsim_controller(circuit, inputs, 1, outputs, 1, 1e-3, 0, NULL, count, &counter) == PWLSIM_OK);
  CHECK(pwlsim_run(circuit, NULL, &result) == PWLSIM_OK && pwlsim_signal(result, "v(a)")[3] == 2 && counter.calls == 4);
  pwlsim_result_free(result);
  counter.calls = 0;
  counter.fails_at = 3;
  CHECK(pwlsim_run(circuit, NULL, &result) == PWLSIM_RUN_FAILED && strcmp(pwlsim_last_error_id(), "E-controller") == 0);
  CHECK(fabs(pwlsim_end(result) - 2e-3) < 1e-15 && strstr(pwlsim_last_error(), "7") != NULL);
  pwlsim_result_free(result);
  pwlsim_circuit_free(circuit);
}

/* A handle of its own a thread, errors included. */
static void* one_thread(void* place) {
  const int number = *(int*)place;
  int k;
  for (k = 0; k < 20; ++k) {
    pwlsim_circuit* circuit = NULL;
    pwlsim_result* result = NULL;
    char id[32];
    if (pwlsim_parse_text(charging, &circuit) != PWLSIM_OK || pwlsim_set_value(circuit, "V1", number) != PWLSIM_OK) return place;
    if (pwlsim_run(circuit, NULL, &result) != PWLSIM_OK || fabs(pwlsim_signal(result, "v(out)")[5] + number * expm1(-5)) > 1e-12) return place;
    sprintf(id, "v(no%d)", number);
    if (pwlsim_signal(result, id) != NULL || strstr(pwlsim_last_error(), id) == NULL) return place;
    pwlsim_result_free(result);
    pwlsim_circuit_free(circuit);
  }
  return NULL;
}

static void test_threads(void) {
  pthread_t threads[4];
  int numbers[4], k;
  void* bad;
  for (k = 0; k < 4; ++k) {
    numbers[k] = k + 1;
    CHECK(pthread_create(&threads[k], NULL, one_thread, &numbers[k]) == 0);
  }
  for (k = 0; k < 4; ++k) CHECK(pthread_join(threads[k], &bad) == 0 && bad == NULL);
}

int main(void) {
  test_arrays();
  test_failures();
  test_options();
  test_controllers();
  test_threads();
  if (failures == 0) puts("all checks hold");
  return failures != 0;
}
