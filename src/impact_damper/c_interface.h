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

/* Runs a scene, given as the JSON text of a scene file (data/schema/scene.schema.json), with the engine
 * "exact", "restitution" or "cem" and its default options; everything is recorded, the motion's history if
 * `history` is not NULL. Returns NULL where that cannot be done, and then writes why into `error`, one line
 * for each problem, cut to `error_size` - 1 characters and ended by '\0'. `error` may be NULL if `error_size`
 * is 0. */
impact_damper_run* impact_damper_simulate(const char* scene, const char* engine,
                                          const impact_damper_window* history, char* error,
                                          size_t error_size);

/* A column by its names in a run file, "half_cycles/amplitude", "history/x", and its number of rows. A number
 * that stands alone is a column of one row: "end_time", "energy/residual". All numbers are dimensionless,
 * also of a scene in units; an absent one is NaN, a wall 0 (left) or 1 (right). NULL and 0 rows if the run
 * has no column of that name; one of 0 rows that exists is not NULL. The column is the run's, valid until
 * impact_damper_free(). */
const double* impact_damper_column(const impact_damper_run* run, const char* name, size_t* rows);

/* Why the run ended, as in a run file: "time", "amplitude", ... A text that is always valid. */
const char* impact_damper_stop_reason(const impact_damper_run* run);

/* NULL is allowed. */
void impact_damper_free(impact_damper_run* run);

#ifdef __cplusplus
}
#endif

#endif
/* NOLINTEND(modernize-deprecated-headers,modernize-use-using,readability-identifier-naming) */
