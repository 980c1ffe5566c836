/* The same library from C: the loss of amplitude in a decay, and the motion at a few times. */
#include <stdio.h>

#include "impact_damper/c_interface.h"

int main(void) {
  const char* scene = "{\"mass_ratio\": 0.05, \"restitution\": 0.5, \"x0\": 3, \"until_time\": 100}";
  const impact_damper_window history = {0, 10, 6};
  char error[1000];
  impact_damper_run* run;
  if (impact_damper_simulate(scene, "exact", &history, &run, error, sizeof error) != IMPACT_DAMPER_DONE) {
    fprintf(stderr, "%s\n", error);
    return 1;
  }

  size_t rows, samples;
  const double* amplitude = impact_damper_column(run, "half_cycles/amplitude", &rows);
  printf("amplitude from %.6f to %.6f in %zu half cycles\n", amplitude[0], amplitude[rows - 1], rows);

  const double* time = impact_damper_column(run, "history/time", &samples);
  const double* x = impact_damper_column(run, "history/x", &samples);
  for (size_t i = 0; i < samples; ++i) printf("x(%2g) = %9.6f\n", time[i], x[i]);
  impact_damper_free(run);
  return 0;
}
