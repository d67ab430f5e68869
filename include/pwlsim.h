#ifndef PWLSIM_H
#define PWLSIM_H
/* The library for C, and for all languages that call C: parse, run, read arrays. See docs/c.md.
 *
 *     pwlsim_circuit* circuit;
 *     pwlsim_result* result = NULL;
 *     if (pwlsim_parse_file("buck.net", &circuit) == PWLSIM_OK && pwlsim_run(circuit, NULL, &result) == PWLSIM_OK)
 *       printf("%g V\n", pwlsim_signal(result, "v(out)")[pwlsim_rows(result) - 1]);
 *     else
 *       fputs(pwlsim_last_error(), stderr);
 *     pwlsim_result_free(result);
 *     pwlsim_circuit_free(circuit);
 *
 * Units are V, A, s, ohm, farad, henry. Names are not case-sensitive. Text is UTF-8 and ends with a zero.
 *
 * Threads: different handles are independent. Several threads may run one circuit and read one result as long as none changes or frees it.
 * Pointers that a function returns belong to the handle and are valid until it is freed; those to the messages of a failure, until the next call of
 * this thread that fails.
 *
 * Binary compatibility: symbols have the version PWLSIM_0.1; functions are added, not changed. */

#include <stddef.h>

#if defined(__GNUC__)
#define PWLSIM_API __attribute__((visibility("default")))
#else
#define PWLSIM_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* What a function returns; pwlsim_last_error() has the sentence. */
enum pwlsim_status {
  PWLSIM_OK = 0,
  PWLSIM_INVALID = 1,     /* the circuit has mistakes, or something requested does not exist */
  PWLSIM_RUN_FAILED = 2,  /* the run could not continue; there is a result, with the rows up to then */
  PWLSIM_INTERRUPTED = 3, /* *interrupt was set; there is a result, with the rows up to then */
  PWLSIM_ARGUMENT = 4,    /* a null pointer, or a number that is out of range, where it is not allowed */
  PWLSIM_INTERNAL = 5     /* no memory, or a defect of the library */
};

typedef struct pwlsim_circuit pwlsim_circuit;
typedef struct pwlsim_result pwlsim_result;

/* "0.1.0" */
PWLSIM_API const char* pwlsim_version(void);

enum pwlsim_kind { PWLSIM_NOTE = 0, PWLSIM_WARNING = 1, PWLSIM_ERROR = 2 };

typedef struct pwlsim_message {
  int kind;         /* enum pwlsim_kind */
  const char* id;   /* docs/reference/messages.md */
  const char* text; /* one sentence */
  const char* full; /* with its location and the line concerned */
} pwlsim_message;

/* The last call of this thread that failed: all its errors in full, and the id of the first ("E-unknown-model"; "" for PWLSIM_ARGUMENT and
 * PWLSIM_INTERNAL). Never null. */
PWLSIM_API const char* pwlsim_last_error(void);
PWLSIM_API const char* pwlsim_last_error_id(void);
/* All its messages: errors, warnings and notes. */
PWLSIM_API size_t pwlsim_error_messages(void);
PWLSIM_API int pwlsim_error_message(size_t number, pwlsim_message* message); /* PWLSIM_ARGUMENT: no such number */

/* ---- Circuits ---------------------------------------------------------------------------------------------------------------- */

/* Reads a deck and checks it without a run. Makes a circuit except with PWLSIM_ARGUMENT and PWLSIM_INTERNAL (*circuit is null then): cards that are added
 * later may correct its mistakes. Each run reads a file again. */
PWLSIM_API int pwlsim_parse_text(const char* deck, pwlsim_circuit** circuit);
PWLSIM_API int pwlsim_parse_file(const char* path, pwlsim_circuit** circuit);
PWLSIM_API int pwlsim_circuit_copy(const pwlsim_circuit* circuit, pwlsim_circuit** copy);
/* Null is allowed. */
PWLSIM_API void pwlsim_circuit_free(pwlsim_circuit* circuit);

/* Lines of the deck language that count as written at the deck's end: elements, .param, .meas, .save. The next run checks them. */
PWLSIM_API int pwlsim_add_cards(pwlsim_circuit* circuit, const char* lines);
/* Sets the value of R, C, L, V, I, E, F, G, H or K outside of subcircuits: a number, or text as on a card ("10k", "SIN(0 10 50)"). The next run checks it. */
PWLSIM_API int pwlsim_set_value(pwlsim_circuit* circuit, const char* element, double value);
PWLSIM_API int pwlsim_set_text(pwlsim_circuit* circuit, const char* element, const char* value);
/* A .param, which overrides that of the deck. */
PWLSIM_API int pwlsim_set_parameter(pwlsim_circuit* circuit, const char* name, double value);
/* The value of an element, with parameters evaluated; also of elements in subcircuits ("X1:R1"). */
PWLSIM_API int pwlsim_get_value(const pwlsim_circuit* circuit, const char* element, double* value);
/* Number of runs of the deck's .step; 1 without .step. */
PWLSIM_API int pwlsim_step_runs(const pwlsim_circuit* circuit, size_t* runs);

/* A sampled controller (docs/reference/controllers.md): at t = k*every the function receives the inputs (signals) as they are just before, and overwrites
 * the outputs (sources of constant value, or nodes), which hold from t + delay on. It returns 0; any other number ends the run (PWLSIM_RUN_FAILED,
 * E-controller). `initial` has one number per output, or is null. `data` is passed to the function. */
typedef int (*pwlsim_function)(double time, const double* inputs, double* outputs, void* data);
PWLSIM_API int pwlsim_controller(pwlsim_circuit* circuit, const char* const* inputs, size_t input_count, const char* const* outputs,
                                 size_t output_count, double every, double delay, const double* initial, pwlsim_function function, void* data);

/* ---- Runs -------------------------------------------------------------------------------------------------------------------- */

enum pwlsim_engine { PWLSIM_AUTOMATIC = 0, PWLSIM_EXACT = 1, PWLSIM_SPARSE = 2 };

/* Zeros are the defaults, except for `size`: sizeof(pwlsim_options), from which the library knows the fields of the caller's version. */
typedef struct pwlsim_options {
  size_t size;
  double stop;                /* s; 0: use the deck's .tran and ignore the next three */
  double step;                /* s between rows; 0: a thousandth of the run. Not an integration step */
  double start;               /* s, of the first row */
  int use_initial_conditions; /* uic */
  int engine;                 /* enum pwlsim_engine */
  double reltol;              /* of the sparse engine; 0: its default */
  int rows_at_events;         /* adds rows before and after every event */
  int without_events;         /* keeps no list of events */
  int without_model;          /* keeps no model: no pwlsim_at and no pwlsim_report */
  size_t run;                 /* of the deck's .step, from 0 */
  const int* interrupt;       /* may be null; another thread or a signal handler sets it to a nonzero number, which ends the run soon */
} pwlsim_options;

/* `options` may be null. *result is null where there is none. */
PWLSIM_API int pwlsim_run(const pwlsim_circuit* circuit, const pwlsim_options* options, pwlsim_result** result);
/* Null is allowed. */
PWLSIM_API void pwlsim_result_free(pwlsim_result* result);

PWLSIM_API int pwlsim_completed(const pwlsim_result* result); /* 1: the run reached its end */
PWLSIM_API double pwlsim_end(const pwlsim_result* result);    /* the time reached, s */

/* Rows: times that do not decrease, and as many values of each signal. */
PWLSIM_API size_t pwlsim_rows(const pwlsim_result* result);
PWLSIM_API const double* pwlsim_time(const pwlsim_result* result);
PWLSIM_API size_t pwlsim_signals(const pwlsim_result* result);
PWLSIM_API const char* pwlsim_signal_name(const pwlsim_result* result, size_t number); /* null: no such number */
PWLSIM_API const double* pwlsim_signal(const pwlsim_result* result, const char* name); /* null: no such signal, PWLSIM_INVALID */
/* Values at any times within [0, pwlsim_end], from the closed form between events. Each call repeats the run: ask for many times in one call. */
PWLSIM_API int pwlsim_at(const pwlsim_result* result, const char* name, const double* times, size_t count, double* values);

typedef struct pwlsim_event {
  double time;     /* s */
  int source_edge; /* a source jumps or has a corner */
  int mode_change; /* diodes or switches change */
  int jump;        /* states jump */
  size_t on_count, off_count;
  const char* const* turned_on; /* names of diodes and switches: "D1", "X1.S1" */
  const char* const* turned_off;
} pwlsim_event;

PWLSIM_API size_t pwlsim_events(const pwlsim_result* result);
PWLSIM_API int pwlsim_get_event(const pwlsim_result* result, size_t number, pwlsim_event* event);

typedef struct pwlsim_measurement {
  const char* name;
  double value;        /* NaN if it failed */
  const char* unit;    /* "V", "W", "s"; "" if it has none */
  const char* failure; /* why there is no value; "" if there is one */
} pwlsim_measurement;

/* .meas, in the order of the cards. */
PWLSIM_API size_t pwlsim_measurements(const pwlsim_result* result);
PWLSIM_API int pwlsim_get_measurement(const pwlsim_result* result, size_t number, pwlsim_measurement* measurement);
/* One by its name: PWLSIM_INVALID if there is none, or it failed. */
PWLSIM_API int pwlsim_measure(const pwlsim_result* result, const char* name, double* value);

typedef struct pwlsim_certificate {
  double complementarity, kcl_kvl, energy; /* largest relative residuals over the run */
  int passive;                             /* 1 yes, 0 no, -1 not known */
} pwlsim_certificate;

PWLSIM_API int pwlsim_get_certificate(const pwlsim_result* result, pwlsim_certificate* certificate);

/* Warnings and notes of the run; also the error that ended it. */
PWLSIM_API size_t pwlsim_result_messages(const pwlsim_result* result);
PWLSIM_API int pwlsim_result_message(const pwlsim_result* result, size_t number, pwlsim_message* message);

/* The run as one web page that needs no network; free its text with pwlsim_text_free. */
PWLSIM_API int pwlsim_report(const pwlsim_result* result, char** page);
PWLSIM_API void pwlsim_text_free(char* text);

#ifdef __cplusplus
}
#endif

#endif
