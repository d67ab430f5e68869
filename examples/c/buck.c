/* A buck converter through the C interface: a run, its arrays, events and measurements; a sweep of a value by a loop; what is wrong with a deck.
 *
 *     cc buck.c $(pkg-config --cflags --libs pwlsim-c) -lm -o buck && ./buck
 *
 * Each ripple stands beside the textbook's, Vin D (1 - D) T / L (Erickson and Maksimovic, Fundamentals of Power Electronics, chapter 2). */

#include <math.h>
#include <pwlsim.h>
#include <stdio.h>

static const char deck[] =
    "buck converter\n"
    "V1 in 0 24\n"
    "VG gate 0 PULSE(0 1 0 0 0 {duty*10u} 10u)\n"
    "S1 in sw gate 0 ideal\n"
    ".model ideal SW(Vt=0.5)\n"
    "D1 0 sw diode\n"
    ".model diode D\n"
    "L1 sw out 47u\n"
    "VO out 0 {duty*24}\n"
    ".param duty=0.5\n"
    ".ic i(L1)=100\n"
    ".save i(L1)\n"
    ".meas tran ripple PP i(L1)\n"
    ".tran 1u 50u uic\n";

static int failed(const char* what) {
  fprintf(stderr, "%s: %s", what, pwlsim_last_error());
  return 1;
}

static int print_ripple(pwlsim_circuit* circuit, double duty, double inductance) {
  const double expected = 24 * duty * (1 - duty) * 10e-6 / inductance;
  pwlsim_result* result = NULL;
  double ripple = 0;
  if (pwlsim_set_parameter(circuit, "duty", duty) != PWLSIM_OK || pwlsim_set_value(circuit, "L1", inductance) != PWLSIM_OK ||
      pwlsim_run(circuit, NULL, &result) != PWLSIM_OK || pwlsim_measure(result, "ripple", &ripple) != PWLSIM_OK)
    return failed("run");
  printf("duty %4.2f  L %3.0f uH  ripple %11.9f A  textbook %11.9f A\n", duty, inductance * 1e6, ripple, expected);
  pwlsim_result_free(result);
  return fabs(ripple - expected) > 1e-9 * expected;
}

int main(void) {
  int bad = 0;
  double duty;
  size_t k;
  pwlsim_circuit* circuit = NULL;
  pwlsim_result* result = NULL;
  pwlsim_event event;
  const double* current;

  printf("pwlsim %s\n", pwlsim_version());
  if (pwlsim_parse_text(deck, &circuit) != PWLSIM_OK || pwlsim_run(circuit, NULL, &result) != PWLSIM_OK) return failed("buck");

  /* The rows, and the first events. */
  current = pwlsim_signal(result, "i(L1)");
  for (k = 0; k < 4; ++k) printf("t = %2.0f us  i(L1) = %.9f A\n", pwlsim_time(result)[k] * 1e6, current[k]);
  for (k = 0; k < 2 && pwlsim_get_event(result, k, &event) == PWLSIM_OK; ++k)
    printf("t = %2.0f us  %s on, %s off\n", event.time * 1e6, event.turned_on[0], event.turned_off[0]);
  bad |= fabs(current[pwlsim_rows(result) - 1] - 100) > 1e-9; /* periodic: it comes back to where it began */
  pwlsim_result_free(result);

  for (duty = 0.25; duty < 0.9; duty += 0.25) bad |= print_ripple(circuit, duty, 47e-6);
  bad |= print_ripple(circuit, 0.5, 100e-6);
  pwlsim_circuit_free(circuit);

  /* A mistake: the circuit is there all the same, and what is added may mend it. */
  if (pwlsim_parse_text("oops\nV1 a 0 1\nD1 a 0 schotky\n.model schottky D\n.tran 1 2\n", &circuit) != PWLSIM_INVALID) return 1;
  printf("%s: %s", pwlsim_last_error_id(), pwlsim_last_error());
  pwlsim_circuit_free(circuit);
  return bad;
}
