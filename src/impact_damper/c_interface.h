/* The library for C, and for languages that can call C: a scene in, columns out. No global state; any number
 * of threads may call these functions, each with runs of its own. */
/* NOLINTBEGIN(modernize-deprecated-headers,modernize-use-using,readability-identifier-naming): this is C */
#ifndef IMPACT_DAMPER_C_INTERFACE_H
#define IMPACT_DAMPER_C_INTERFACE_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct impact_damper_run impact_damper_run;

/* Equally spaced samples of the motion, both ends included: 0 <= begin < end, count >= 2. */
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

/* Runs a scene, given as the JSON text of a scene file (data/schema/scene.schema.json), with the engine
 * "exact", "restitution" or "cem" and its default options, or with the JSON text of the object "engine" of a
 * run file, in which all but its name may be missing: {"name": "cem", "time_step": 1e-4}; everything is
 * recorded, the motion's history if `history` is not NULL. `*run` becomes the run, to be given to
 * impact_damper_free(). Where that cannot be done it becomes NULL, and `error` says why, one line for each
 * problem, cut to `error_size` - 1 characters and ended by '\0'. `error` may be NULL if `error_size` is 0. */
impact_damper_status impact_damper_simulate(const char* scene, const char* engine,
                                            const impact_damper_window* history, impact_damper_run** run,
                                            char* error, size_t error_size);

/* A column by its names in a run file, "half_cycles/amplitude", "history/x", and its number of rows. A number
 * that stands alone is a column of one row: "end_time", "energy/residual". All numbers are dimensionless,
 * also of a scene in units, but for "units/length_m" and the others that say what a unit is; an absent one is
 * NaN, a wall 0 (left) or 1 (right). NULL and 0 rows if the run has no column of that name; one of 0 rows
 * that exists is not NULL. The column is the run's, valid until impact_damper_free(). */
const double* impact_damper_column(const impact_damper_run* run, const char* name, size_t* rows);

/* The name of each column, in the order of a run file: `index` counts from 0, behind the last the name is
 * NULL. `*stands_alone` becomes 1 for a number that stands alone, 0 for a list. The name is the run's, too.
 */
const char* impact_damper_column_name(const impact_damper_run* run, size_t index, int* stands_alone);

/* Why the run ended, as in a run file: "time", "amplitude", ... A text that is always valid. */
const char* impact_damper_stop_reason(const impact_damper_run* run);

/* The whole run file, as `impact-damper run` writes it, ended by '\0': the caller's, to be given to free().
 * NULL if there is no memory for it. */
char* impact_damper_run_text(const impact_damper_run* run);

/* NULL is allowed. */
void impact_damper_free(impact_damper_run* run);

#ifdef __cplusplus
}
#endif

#endif
/* NOLINTEND(modernize-deprecated-headers,modernize-use-using,readability-identifier-naming) */
