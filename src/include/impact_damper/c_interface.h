/* The library for C, and for languages that can call C: a scene in, columns out. There is no global state:
 * any number of threads may call these functions, each with runs of its own. */
/* NOLINTBEGIN(modernize-deprecated-headers,modernize-use-using,readability-identifier-naming): this is C */
#ifndef IMPACT_DAMPER_C_INTERFACE_H
#define IMPACT_DAMPER_C_INTERFACE_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct impact_damper_run impact_damper_run;

/* Equally spaced samples of the motion, both ends included: 0 <= begin < end <= 1e12, 2 <= count <= 500000,
 * of a scene with a list of n dampers count <= 500000 / n. Times are dimensionless, also for a scene in
 * units: divided by 1/Omega_n. Samples after the end of the run are left out. */
typedef struct impact_damper_window {
  double begin, end;
  size_t count;
} impact_damper_window;

typedef enum impact_damper_status {
  IMPACT_DAMPER_DONE = 0,
  IMPACT_DAMPER_INVALID = 1, /* the scene, the engine or the window is not valid */
  IMPACT_DAMPER_NUMERICAL_FAILURE =
      2, /* a result is not finite, or this process's arithmetic is not IEEE 754's */
  IMPACT_DAMPER_OUT_OF_MEMORY = 3
} impact_damper_status;

/* Runs a scene, given as the JSON text of a scene file (data/schema/scene.schema.json). `engine` is the name
 * "exact", "restitution" or "cem", with default options, or the JSON text of the object "engine" of a run
 * file, in which only "name" must be given: {"name": "cem", "time_step": 1e-4}. Half cycles, impacts,
 * contacts and energy are recorded, and the motion's history if `history` is not NULL. `*run` becomes the
 * run, to be freed by impact_damper_free(). Without success it becomes NULL, and `error` says why, one line
 * for each problem, cut to `error_size` - 1 bytes and ended by '\0'. `error` may be NULL if `error_size` is
 * 0; `run` must not be NULL, nor may any argument of the functions below unless they say so. A run that
 * reaches one of its budgets is a success: impact_damper_stop_reason() reports it. */
impact_damper_status impact_damper_simulate(const char* scene, const char* engine,
                                            const impact_damper_window* history, impact_damper_run** run,
                                            char* error, size_t error_size);

/* What a run records beside its half cycles. What is not recorded takes no time: energy is most of it. */
typedef enum impact_damper_record {
  IMPACT_DAMPER_IMPACTS = 1,
  IMPACT_DAMPER_CONTACTS = 2,
  IMPACT_DAMPER_ENERGY = 4
} impact_damper_record;

/* The same, but records only `record`, a sum of the above or 0. */
impact_damper_status impact_damper_simulate_recording(const char* scene, const char* engine, unsigned record,
                                                      const impact_damper_window* history,
                                                      impact_damper_run** run, char* error,
                                                      size_t error_size);

/* A column by its names in a run file, "half_cycles/amplitude", "history/x", and its number of rows. A number
 * that stands alone is a column of one row: "end_time", "energy/residual". All numbers are dimensionless,
 * also of a scene in units, except "units/length_m" and the other sizes of a unit in SI. An absent
 * number is NaN; a wall is 0 (left) or 1 (right). Several dampers are numbered from 1, in "impacts/damper" as
 * in the names of their own columns: "history/dampers/1/y". The result is NULL, with 0 rows, if the run has
 * no column of that name; it is not NULL for an existing column of 0 rows. It points into the run and is
 * valid until impact_damper_free(). */
const double* impact_damper_column(const impact_damper_run* run, const char* name, size_t* rows);

/* The name of each column, in the order of a run file: `index` counts from 0; the result is NULL for an index
 * after the last. `*stands_alone` becomes 1 for a number that stands alone, 0 for a list. The name is valid
 * until impact_damper_free(). */
const char* impact_damper_column_name(const impact_damper_run* run, size_t index, int* stands_alone);

/* Why the run ended, as in a run file: "time", "amplitude", or the budget that was reached. The text stays
 * valid after impact_damper_free(). */
const char* impact_damper_stop_reason(const impact_damper_run* run);

/* The averaged loss factor, per radian, from the peaks of the half cycles: `eta` at `amplitude` and `time`,
 * in the order of time, as in Figures 8 to 14 (analysis/loss_factor.hpp). Each of the three arrays must have
 * place for as many numbers as "half_cycles/amplitude" has rows; the result is how many were filled, 0 for a
 * run of 10 half cycles or fewer. Needs memory for as many numbers; 0 without it, too. */
size_t impact_damper_loss_factor(const impact_damper_run* run, double* amplitude, double* time, double* eta);

/* The amplitude at which bounce-down ended: that of the last of the first four or more successive half cycles
 * in each of which the mass sticks to a wall (analysis/regimes.hpp). NaN if there were none, if the run ends
 * among them, for a scene with a list of dampers, and if contacts were not recorded. */
double impact_damper_bounce_down_end(const impact_damper_run* run);

/* The text of the run file, as `impact-damper run` writes it, ended by '\0'; the caller must free() it. NULL
 * if there is not enough memory, or if a number of the run is not finite. */
char* impact_damper_run_text(const impact_damper_run* run);

/* Frees the run, its columns and their names. NULL is allowed. */
void impact_damper_free(impact_damper_run* run);

#ifdef __cplusplus
}
#endif

#endif
/* NOLINTEND(modernize-deprecated-headers,modernize-use-using,readability-identifier-naming) */
