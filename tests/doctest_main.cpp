// doctest itself and its main function, compiled once for all tests.
//
// Every run that a test program makes, in its own code or through the library's, is held against itself: the
// linker (--wrap, CMakeLists.txt) leads simulate()'s call of Recorder::finish(), by which a run is complete,
// here.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include "impact_damper/analysis/consistency.hpp"
#include "impact_damper/engines/recorder.hpp"
#include "impact_damper/io/scene_file.hpp"

namespace every_run {

using namespace impact_damper;

// The member function itself and what is called in its place, by the names that the linker gives them.
void finish(Recorder* recorder, Run& run) asm("__real_" FINISH);
void finish_and_examine(Recorder* recorder, Run& run) asm("__wrap_" FINISH);

void finish_and_examine(Recorder* recorder, Run& run) {
  finish(recorder, run);
  if (!doctest::is_running_in_test) return;
  if (!problems_of(run.scene).empty()) return;  // no run of simulate()'s: a recorder's alone, without scene
  for (const Problem& problem : inconsistencies_of(run))
    FAIL_CHECK(std::string(name_of(run.engine)), " run of ", scene_text(run.scene), ": ", problem.field, ": ",
               problem.message);
}

}  // namespace every_run
