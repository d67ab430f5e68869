/* pwlsim in Octave, by its interface for functions in C (MEX):
 *
 *     mkoctfile --mex pwlsim_run.c $(pkg-config --cflags --libs pwlsim-c)
 *
 *     result = pwlsim_run (deck)                      runs a deck: its text, or with `.include` a line that names its file
 *     result = pwlsim_run (deck, "duty", 0.4, ...)    with parameters, which override those of the deck
 *
 * `result` is a struct:
 *     time          rows x 1, s
 *     names         cell array of the saved signals, 1 x signals
 *     values        rows x signals, V or A
 *     events        times of switching, n x 1, s
 *     measurements  struct with one field a .meas; NaN where it failed
 *
 * Mistakes in the deck, and a run that cannot go on, are Octave errors with the message's id ("pwlsim:E-unknown-model"); warnings are Octave warnings. */

#include <math.h>
#include <mex.h>
#include <pwlsim.h>
#include <stdio.h>
#include <string.h>

/* Frees what is not null, and leaves the function by an Octave error with the id and text of the last failure. */
static void fail(pwlsim_circuit* circuit, pwlsim_result* result) {
  char id[100], text[4000];
  const char* given = pwlsim_last_error_id();
  snprintf(id, sizeof id, "pwlsim:%s", *given ? given : "failure");
  snprintf(text, sizeof text, "%s", pwlsim_last_error());
  pwlsim_result_free(result);
  pwlsim_circuit_free(circuit);
  mexErrMsgIdAndTxt(id, "%s", text);
}

static pwlsim_circuit* read_deck(int argument_count, const mxArray* arguments[]) {
  pwlsim_circuit* circuit = NULL;
  char* deck;
  int k;
  if (argument_count % 2 == 0 || !mxIsChar(arguments[0])) mexErrMsgIdAndTxt("pwlsim:usage", "usage: pwlsim_run (deck, \"parameter\", value, ...)");
  for (k = 1; k < argument_count; k += 2)
    if (!mxIsChar(arguments[k]) || !mxIsDouble(arguments[k + 1]) || mxGetNumberOfElements(arguments[k + 1]) != 1)
      mexErrMsgIdAndTxt("pwlsim:usage", "a parameter is a name and a number");
  deck = mxArrayToString(arguments[0]); /* Octave frees it, also after an error */
  /* Mistakes that a parameter mends do not count: the run checks the deck again. */
  if (pwlsim_parse_text(deck, &circuit) != PWLSIM_OK && (circuit == NULL || argument_count == 1)) fail(circuit, NULL);
  for (k = 1; k < argument_count; k += 2)
    if (pwlsim_set_parameter(circuit, mxArrayToString(arguments[k]), mxGetScalar(arguments[k + 1])) != PWLSIM_OK) fail(circuit, NULL);
  return circuit;
}

static mxArray* column(const double* values, size_t count) {
  mxArray* made = mxCreateDoubleMatrix(count, 1, mxREAL);
  if (count > 0) memcpy(mxGetPr(made), values, count * sizeof(double));
  return made;
}

static void set_signals(mxArray* made, const pwlsim_result* result) {
  const size_t rows = pwlsim_rows(result), signals = pwlsim_signals(result);
  mxArray* names = mxCreateCellMatrix(1, signals);
  mxArray* values = mxCreateDoubleMatrix(rows, signals, mxREAL);
  size_t k;
  for (k = 0; k < signals; ++k) {
    const char* name = pwlsim_signal_name(result, k);
    mxSetCell(names, k, mxCreateString(name));
    if (rows > 0) memcpy(mxGetPr(values) + k * rows, pwlsim_signal(result, name), rows * sizeof(double));
  }
  mxSetField(made, 0, "time", column(pwlsim_time(result), rows));
  mxSetField(made, 0, "names", names);
  mxSetField(made, 0, "values", values);
}

static mxArray* switching_times(const pwlsim_result* result) {
  const size_t count = pwlsim_events(result);
  mxArray* times = mxCreateDoubleMatrix(count, 1, mxREAL);
  size_t used = 0, k;
  for (k = 0; k < count; ++k) {
    pwlsim_event event;
    if (pwlsim_get_event(result, k, &event) == PWLSIM_OK && event.mode_change) mxGetPr(times)[used++] = event.time;
  }
  mxSetM(times, used);
  return times;
}

static mxArray* measurements(const pwlsim_result* result) {
  mxArray* made = mxCreateStructMatrix(1, 1, 0, NULL);
  size_t k;
  for (k = 0; k < pwlsim_measurements(result); ++k) {
    pwlsim_measurement measurement;
    if (pwlsim_get_measurement(result, k, &measurement) != PWLSIM_OK) continue;
    mxAddField(made, measurement.name);
    mxSetField(made, 0, measurement.name, mxCreateDoubleScalar(measurement.value));
  }
  return made;
}

static void tell_warnings(const pwlsim_result* result) {
  size_t k;
  for (k = 0; k < pwlsim_result_messages(result); ++k) {
    pwlsim_message message;
    char id[100];
    if (pwlsim_result_message(result, k, &message) != PWLSIM_OK || message.kind != PWLSIM_WARNING) continue;
    snprintf(id, sizeof id, "pwlsim:%s", message.id);
    mexWarnMsgIdAndTxt(id, "%s", message.text);
  }
}

void mexFunction(int output_count, mxArray* outputs[], int argument_count, const mxArray* arguments[]) {
  static const char* fields[] = {"time", "names", "values", "events", "measurements"};
  pwlsim_circuit* circuit = read_deck(argument_count, arguments);
  pwlsim_result* result = NULL;
  (void)output_count;
  if (pwlsim_run(circuit, NULL, &result) != PWLSIM_OK) fail(circuit, result);
  outputs[0] = mxCreateStructMatrix(1, 1, 5, fields);
  set_signals(outputs[0], result);
  mxSetField(outputs[0], 0, "events", switching_times(result));
  mxSetField(outputs[0], 0, "measurements", measurements(result));
  tell_warnings(result);
  pwlsim_result_free(result);
  pwlsim_circuit_free(circuit);
}
