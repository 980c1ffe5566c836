# The tests that are commands of their own, scripts mostly. Included by CMakeLists.txt.

# Debian's own Python has what the scripts import; another one that stands before it in PATH may not.
find_program(PYTHON3 python3 PATHS /usr/bin NO_DEFAULT_PATH)
find_program(PYTHON3 python3)
set(Python3_EXECUTABLE ${PYTHON3})
find_package(Python3 3.9 REQUIRED COMPONENTS Interpreter)

set(tests ${CMAKE_CURRENT_SOURCE_DIR})
set(made ${CMAKE_CURRENT_BINARY_DIR})
set(source ${PROJECT_SOURCE_DIR})
set(program $<TARGET_FILE:impact-damper>)
set(exact_runs ${PROJECT_BINARY_DIR}/runs/exact)
set(new ${made}/readme/new)  # what paper/refresh makes

# command_test(NAME LABEL [LONG] COMMAND WORD... [PROPERTIES NAME VALUE...]). Exit code 77: what it needs is not here.
# LONG: long_test(). COST is about its seconds. Where several tests run at once those with the highest begin, so that no
# long one is left to run alone at the end.
function(command_test name label)
  cmake_parse_arguments(PARSE_ARGV 2 test "LONG" "" "COMMAND;PROPERTIES")
  add_test(NAME ${name} COMMAND ${test_COMMAND})
  set_tests_properties(${name} PROPERTIES LABELS ${label} SKIP_RETURN_CODE 77 ${test_PROPERTIES})
  if(test_LONG)
    long_test(${name})
  endif()
endfunction()

# python_test(NAME LABEL [LONG] SCRIPT WORD... [PROPERTIES NAME VALUE...]): a script of this folder, which finds the modules that
# stand here (trial.py, packed_files.py), and its arguments.
function(python_test name label)
  cmake_parse_arguments(PARSE_ARGV 2 test "LONG" "" "PROPERTIES")
  list(POP_FRONT test_UNPARSED_ARGUMENTS script)
  set(long)
  if(test_LONG)
    set(long LONG)
  endif()
  command_test(${name} ${label} ${long} COMMAND ${PYTHON3} -B ${tests}/${script} ${test_UNPARSED_ARGUMENTS}
               PROPERTIES ENVIRONMENT PYTHONPATH=${tests} ${test_PROPERTIES})
endfunction()

# What the text of the sources and documents must be (checks/sources.py).
python_test("checks: each source includes what it uses of the standard library" unit checks/sources.py includes)
python_test("readme: every link of every Markdown file leads somewhere" regression checks/sources.py links)
python_test("readme: the equations that the code cites stand in docs/mathematics.md, and each is cited" regression
            checks/sources.py equations)
python_test("readme: the folders of src/ include only what arrows lead to in docs/architecture.md" regression
            checks/sources.py layers)
python_test("same bits: no source names what depends on more than the input" regression checks/sources.py scan)
command_test("readme: CITATION.cff and CHANGELOG.md know the version" regression
             COMMAND sh -c [[grep -qx "version: \"$0\"" CITATION.cff && grep -q "^## \[$0\]" CHANGELOG.md]] ${PROJECT_VERSION}
             PROPERTIES WORKING_DIRECTORY ${source})
find_program(DOXYGEN doxygen)
if(DOXYGEN)
  command_test("readme: Doxygen reads the public headers without a warning" regression
               COMMAND sh -c [[rm -rf "$0" && mkdir -p "$0" && OUTPUT=$0 "$1" docs/Doxyfile &&
                               grep -q "initial displacement of the primary mass" "$0"/html/structimpact__damper_1_1Scene.html]]
                       ${made}/readme/doxygen ${DOXYGEN}
               PROPERTIES WORKING_DIRECTORY ${source})
endif()

# No result goes through a transcendental function of the C library: nothing that makes one links to any.
command_test("imports: no transcendental function of the C library" unit
             COMMAND ${CMAKE_COMMAND} -DNM=${CMAKE_NM}
                     "-DFILES=$<TARGET_FILE:impact_damper>;$<TARGET_FILE:impact_damper_application>;${program}"
                     -P ${tests}/imports.cmake)

# No test is lost between `make check` and `make check-long`.
python_test("checks: each test is run by one of make check and make check-long" unit checks/sources.py tests
            ${PROJECT_BINARY_DIR})

# The program from outside.

# The lines of command_lines.txt, in four processes, and each packed file of corpus/, in two; a failure names its line or file.
foreach(part 1 2 3 4)
  python_test("cli: command lines, part ${part} of 4" cli cli/command_lines.py ${program} ${tests}/cli/command_lines.txt
              ${made}/cli/lines-${part} --share ${part}/4 PROPERTIES COST 6)
endforeach()
foreach(part 1 2)
  python_test("corpus: files, part ${part} of 2" cli cli/command_lines.py ${program} ${tests}/corpus
              ${made}/corpus/files-${part} --share ${part}/2 PROPERTIES COST 3)
endforeach()

# The published schemas.
foreach(nth 1 20)
  set(name "the same files")
  set(long LONG)
  if(nth EQUAL 20)
    set(name "the same of every twentieth changed file")
    set(long)
  endif()
  math(EXPR seconds "60 / ${nth}")
  python_test("corpus: the schemas and the program allow ${name}" cli ${long} corpus/agree.py ${program}
              ${made}/corpus/changed-${nth} ${nth} PROPERTIES COST ${seconds} PROCESSORS 2)
endforeach()
set(limit)
if(CMAKE_CXX_FLAGS MATCHES "sanitize=")
  set(limit unlimited)
endif()
command_test("corpus: a file of 1 GB is rejected within 200 MB" cli
             COMMAND ${tests}/corpus/too_long.sh ${program} ${made}/corpus/long ${limit})

# The files of files.packed, for the tests that a shell runs.
set(files ${made}/cli/files)
file(MAKE_DIRECTORY ${made}/cli)
python_test("cli: files are unpacked" cli packed_files.py unpack ${tests}/cli/files.packed ${files}
            PROPERTIES FIXTURES_SETUP cli_files)
command_test("cli: standard output on a full disk" cli
             COMMAND sh -c [[error=$("$0" run --until-time 5 2>&1 > /dev/full)
                             test $? = 5 &&
                             test "$error" = "standard output: cannot be written: No space left on device"]] ${program})
# A verdict that is not as recorded: the table is printed all the same, and the exit code says so.
command_test("cli: verify with a verdict that is not as recorded" cli
             COMMAND sh -c [[table=$("$0" verify --claims "$1")
                             test $? = 1 && echo "$table" | grep -q "reproduced <-- recorded: not reproduced"]]
                     ${program} ${files}/changed.json
             PROPERTIES FIXTURES_REQUIRED cli_files)
command_test("cli: verify writes its table as Markdown" cli
             COMMAND sh -c [["$0" verify --claims "$1" --markdown verdicts.md > /dev/null &&
                             grep -q "^| step-limit | 1 | Largest stable step | 2 pi | 2 |" verdicts.md]]
                     ${program} ${files}/claims.json
             PROPERTIES FIXTURES_REQUIRED cli_files WORKING_DIRECTORY ${made}/cli)
python_test("cli: verdicts hold the further numbers of a claim, and what is open is no claim" cli cli/outputs.py ${program}
            ${made}/cli/verdicts verdicts)
# The runs of an ensemble, verdicts and a table with an ensemble's band do not depend on the number of threads. At last the same
# as CSV, in a folder for all tables.
command_test("cli: equal bytes with any number of threads" cli
             COMMAND sh -c [[for threads in 1 2 5
                             do
                               mkdir -p runs-$threads
                               "$0" run --scene "$1/data/scenes/small.json" --record half_cycles,impacts \
                                 --members 5 --threads $threads -o runs-$threads/small.json || exit 1
                               "$0" verify --claims "$1/ensemble.json" --runs runs-$threads --members 5 \
                                 --scenes "$1/data/scenes" \
                                 --threads $threads -o verdicts-$threads.json > verdicts-$threads.txt || exit 1
                               "$0" series --catalogue "$1/band.json" --runs runs-$threads --threads $threads \
                                 --scenes "$1/data/scenes" \
                                 -o band-$threads.dat || exit 1
                             done
                             grep -q band-1 band-1.dat && test -e runs-1/small.members/05.json && for threads in 2 5
                             do
                               diff -r runs-1 runs-$threads &&
                               cmp verdicts-1.json verdicts-$threads.json && cmp verdicts-1.txt verdicts-$threads.txt &&
                               cmp band-1.dat band-$threads.dat || exit 1
                             done
                             mkdir -p tables && "$0" series --catalogue "$1/band.json" --runs runs-1 --scenes "$1/data/scenes" \
                               --format csv -o tables && grep -q ^band-1, tables/fig08.csv]] ${program} ${files}
             PROPERTIES FIXTURES_REQUIRED cli_files WORKING_DIRECTORY ${made}/cli)

python_test("cli: check, verify and series find runs that were altered or are of another scene or engine" cli cli/altered.py
            ${program} ${made}/cli/altered PROPERTIES COST 10)
python_test("cli: tables as CSV hold the numbers of the tables that gnuplot draws" cli cli/outputs.py
            ${program} ${made}/cli/csv_tables tables ${PROJECT_BINARY_DIR}/series/exact PROPERTIES FIXTURES_REQUIRED exact_figures)
python_test("cli: responses are as their schema says, as CSV hold the same numbers, and are not left half written" cli
            cli/responses.py ${program} ${made}/cli/responses)
python_test("cli: with the name - a command prints what it writes to a file, and nothing else" cli cli/outputs.py
            ${program} ${made}/cli/standard_output standard_output PROPERTIES COST 5)
python_test("cli: a map has the best point, the margin and the cells of its table, as Python's csv reads it" cli cli/map.py
            ${program} ${made}/cli/map PROPERTIES COST 4)
python_test("cli: the table of design charts has the means of its sweep, and takes no sweep of another plan" cli
            cli/outputs.py ${program} ${made}/cli/design_charts design_charts)
python_test("cli: what design says of a design is what run and sweep say of it, with any number of threads" cli cli/designs.py
            ${program} ${made}/cli/designs PROPERTIES COST 5)
python_test("cli: sweeps have the same bytes however they are made, hold the numbers of runs, and are not mixed" cli
            cli/sweeps.py ${program} ${made}/cli/sweeps PROPERTIES COST 10)
python_test("cli: compare finds what was done to a record, and fits the numbers it was made with" cli LONG cli/compare.py
            ${program} ${made}/cli/compare PROPERTIES COST 30)

# impact-damper report: its pages, and what it does where something is missing.
python_test("report: pages about very different scenes are whole, and their numbers those of a run" pipeline LONG
            own_report/scenes.py ${program} ${made}/own_report/scenes PROPERTIES FIXTURES_SETUP own_pages)
python_test("report: a page in units, one of a forced scene and one of several dampers are whole, and their numbers those of a run"
            pipeline own_report/scenes.py ${program} ${made}/own_report/two_scenes "slip of the units" "two motions" "several")
python_test("report: without gnuplot, interrupted, or moved away" pipeline own_report/hindered.py ${program}
            ${made}/own_report/hindered)
python_test("report: its pages in a browser" paper LONG paper/browser.py ReportsAboutScenes ${made}/own_report/scenes
            PROPERTIES FIXTURES_REQUIRED own_pages)

# A small catalogue from its scene to its figures, and what happens when something between is broken.
foreach(case draws repeats missing_run short_run run_without_number missing_table nan_in_table lost_curve broken_script
             complaining_script gnuplot_draws_nothing)
  string(REPLACE _ " " words ${case})
  command_test("pipeline: ${words}" pipeline
               COMMAND ${CMAKE_COMMAND} -DCASE=${case} -DPROGRAM=${program} -DFIGURES=${source}/figures
                       -DFOLDER=${made}/pipeline/${case} -P ${tests}/pipeline.cmake)
endforeach()

# README.md, docs/report.md, paper/ and data/reference/ against the program: paper/refresh makes them anew, and nothing may differ.
command_test("readme: figures and tables of the exact engine can be built" regression
             COMMAND ${CMAKE_COMMAND} --build ${PROJECT_BINARY_DIR} --target figures-exact runs-exact
             PROPERTIES FIXTURES_SETUP exact_figures RUN_SERIAL ON)
command_test("reference: tables of the other engines are what the program makes" regression LONG
             COMMAND sh -c [["$1" --build . --target series-restitution series-cem &&
                             sha256sum series/restitution/*.dat series/cem/*.dat | diff "$0" -]]
                     ${source}/data/reference/other-engines.sha256 ${CMAKE_COMMAND}
             PROPERTIES RUN_SERIAL ON WORKING_DIRECTORY ${PROJECT_BINARY_DIR})
command_test("readme: all tables, outputs and figures can be made anew" regression
             COMMAND sh -c [[rm -rf "$2" && "$0/paper/refresh" "$1" "$2"]] ${source} ${PROJECT_BINARY_DIR} ${new}
             PROPERTIES FIXTURES_REQUIRED exact_figures FIXTURES_SETUP refreshed)
# refreshed_test(NAME COMMAND...): holds what is committed against what is in ${new}.
function(refreshed_test name)
  command_test(${name} regression COMMAND ${ARGN} PROPERTIES FIXTURES_REQUIRED refreshed)
endfunction()
# sh -c ${compare} COMMITTED NEW FILE...: fails if a file differs in these two folders, and shows where.
set(compare [[new=$1 differing=
              shift
              for file
              do
                cmp -s "$0/$file" "$new/$file" && continue
                echo "$file is not what the program makes:"
                diff "$0/$file" "$new/$file" | cut -c 1-300 | head -n 20
                differing=1
              done
              [ -z "$differing" ] || ! echo "If the new one is right: make reference"]])
# same_files_test(NAME FILE...): each is what paper/refresh makes.
function(same_files_test name)
  refreshed_test(${name} sh -c ${compare} ${source} ${new} ${ARGN})
endfunction()
same_files_test("readme: every output and verdict printed in it is the program's" README.md)
foreach(page compare response sweeps walls)
  same_files_test("readme: every output printed in docs/${page}.md is the program's" docs/${page}.md)
endforeach()
same_files_test("readme: docs/report.md has the numbers and verdicts of the results" docs/report.md)
refreshed_test("readme: the pictures of the examples are the program's"
               sh -c [[cd "$1/data/examples" || exit
                       cmp -s "$1/data/reference/made_with.txt" "$2/data/reference/made_with.txt" ||
                         exec "$0/same_bits/differences.py" --drawn . "$2/data/examples" *.svg
                       exec sh -c "$3" . "$2/data/examples" *.svg]] ${tests} ${source} ${new} ${compare})
same_files_test("paper: every output and verdict printed in it is the program's" paper/claims.md paper/deviations.md)
refreshed_test("reference: tables, figures and sums are what the program makes"
               ${tests}/same_bits/differences.py --reference ${source}/data/reference ${new}/data/reference)

# What the project says of itself to those who cite it, held against its formats and against the files.
same_files_test("citing: what describes the project for programs is up to date" CITATION.cff codecheck.yml)
python_test("citing: CITATION.cff, codecheck.yml and the RO-Crate keep to their formats" regression citing/formats.py ${new}
            PROPERTIES FIXTURES_REQUIRED refreshed)
python_test("citing: every stamp leads from its picture to its data, and back to the picture" regression citing/leads_back.py
            ${program} ${made}/citing/tree ${new} PROPERTIES FIXTURES_REQUIRED refreshed)
python_test("citing: an archive has the same bytes twice, what the manifest lists, and its commit" regression LONG
            citing/archive.py ${new} ${made}/citing/archive PROPERTIES FIXTURES_REQUIRED refreshed)

# The report, read as text and in a browser; skipped where pandoc or Chromium is not installed.
python_test("paper: the numbers of the report follow the results, none is typed" paper LONG paper/report.py ${PROJECT_BINARY_DIR}
            ${new}/data/reference/verdicts.json ${made}/paper
            PROPERTIES FIXTURES_REQUIRED "exact_figures;refreshed" FIXTURES_SETUP report)
python_test("paper: the report in a browser" paper LONG paper/browser.py Report
            ${made}/paper/as-it-is/report.html ${PROJECT_BINARY_DIR}/series/exact ${made}/paper/screenshots PROPERTIES FIXTURES_REQUIRED report COST 25)

# verify must notice a wrong model.
command_test("verify: three planted faults are noticed" regression LONG
             COMMAND ${CMAKE_COMMAND} -DSOURCE=${source} -DFOLDER=${made}/planted_faults/copy -P ${tests}/planted_faults.cmake
             PROPERTIES TIMEOUT 1500 COST 80)

# The first minutes: what `make deps` and `make install` do, docs/adding.md tried with the installed program, and
# examples/ with the installed library.
set(root ${made}/installed/root)
set(installed ${root}/opt/it/bin/impact-damper)
python_test("installed: .ci/install waits for another apt" cli installed/waits.py ${source}/.ci/install ${made}/installed/waits)
command_test("installed: configuring says nothing of the bench to who has not asked for it" cli LONG
             COMMAND sh -c [[said=$(cmake -S "$0" -B "$1" -G Ninja 2>&1) && said=$said$(cmake "$1" -DBUILD_TESTING=ON 2>&1) &&
                             echo "$said" && ! echo "$said" | grep -iE "bench:|odeint|sundials|siconos|float128"]]
                     ${source} ${made}/installed/configured)
command_test("installed: program, data, man page and completions are put under DESTDIR and PREFIX" cli
             COMMAND sh -c [[rm -rf "$1" "$0/generated/impact-damper.1" && cmake --build "$0" && DESTDIR=$1 cmake --install "$0" --prefix /opt/it]]
                     ${PROJECT_BINARY_DIR} ${root}
             PROPERTIES FIXTURES_SETUP installed RUN_SERIAL ON)
python_test("installed: the program finds its files from any folder, and pages and shells know every option" cli
            installed/installed.py ${installed} ${made}/installed/elsewhere ${program} ${exact_runs}
            PROPERTIES FIXTURES_REQUIRED "installed;exact_figures")
python_test("installed: docs/adding.md works as it says, outside the tree" cli installed/adding.py ${installed}
            ${made}/installed/adding PROPERTIES FIXTURES_REQUIRED installed)
# With other sanitizers than the library's, or none, a stranger's program does not link.
if(NOT CMAKE_CXX_FLAGS MATCHES "sanitize=")
  python_test("installed: a stranger's project finds the library and gets the program's bytes" cli LONG installed/library.py
              ${installed} ${made}/installed/library ${CMAKE_CXX_COMPILER}
              PROPERTIES FIXTURES_REQUIRED installed COST 40)
endif()

# The Python module, where it is built, and as it is installed.
if(TARGET impact_damper_python)
  command_test("python: the module gives the program's bits as numpy arrays" unit
               COMMAND ${MODULE_PYTHON} -B ${tests}/python/test_module.py ${program} $<TARGET_FILE:impact_damper_python>
                       ${source} ${made}/python)
  command_test("python: the module is installed where this Python looks, and elsewhere it is said how to have it found" unit
               COMMAND ${MODULE_PYTHON} -B ${tests}/python/installed.py ${PROJECT_BINARY_DIR}
                       ${made}/python/installed ${PROJECT_VERSION} PROPERTIES ENVIRONMENT PYTHONPATH=${tests})
endif()

# What is ended, or hindered, from outside (nothing_lost/scratch.py): nothing is lost, nothing is half done. The longest form
# of the kills is `make kills`. A skipped part is told in the log, and the test counts as skipped (unwritable.py).
add_library(hold MODULE nothing_lost/hold.cpp)
target_link_libraries(hold PRIVATE impact_damper_options ${CMAKE_DL_LIBS})
# outside_test(NAME COST SCRIPT ARGUMENT...)
function(outside_test name cost script)
  string(MAKE_C_IDENTIFIER "${name}" folder)
  python_test("nothing lost: ${name}" nothing_lost LONG nothing_lost/${script} ${program}
              ${made}/nothing_lost/${folder} ${ARGN} PROPERTIES COST ${cost})
endfunction()
outside_test("killed at random moments" 20 killed.py --hold $<TARGET_FILE:hold> --kills 30 --figures 7 10 13)
outside_test("interrupted, and made twice at once" 15 interrupted.py)
outside_test("on full and read-only disks" 7 unwritable.py)
outside_test("what has not changed keeps its time stamp" 20 stamps.py)
outside_test("beyond all bounds" 25 bounds.py --scenes 6)
# The checks themselves, against a program that writes directly to the final name, and takes its time.
outside_test("a program that writes half files is found out" 130 planted.py --hold $<TARGET_FILE:hold>)
add_custom_target(kills
  COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${tests} ${PYTHON3} ${tests}/nothing_lost/killed.py ${program}
          ${made}/nothing_lost/kills --hold $<TARGET_FILE:hold> --kills 110
  DEPENDS impact-damper hold USES_TERMINAL VERBATIM)

# Six seconds for each reader, two readers at a time.
command_test("fuzz: no input of the readers crashes them" fuzz LONG
             COMMAND ${tests}/fuzz/run 6 ${PROJECT_BINARY_DIR}/count PROPERTIES TIMEOUT 1500 COST 70)

# A run of each engine, forced and damped, watched instruction by instruction. A sanitizer's program cannot be.
if(NOT CMAKE_CXX_FLAGS MATCHES "sanitize=")
  foreach(engine exact restitution cem)
    command_test("valgrind: a run of the ${engine} engine keeps to its memory, and gives the same bytes" valgrind LONG
                 COMMAND ${tests}/checks/valgrind.sh ${program} ${made}/valgrind/${engine} --engine ${engine} --until-time 60
                         --scene ${tests}/same_bits/scenes/forced-near-resonance.json)
  endforeach()
endif()

# Equal bits. The matrix itself is no test of CTest: it builds the program nine times. `make same-bits`, .ci/run.
add_custom_target(same-bits COMMAND ${tests}/same_bits/matrix.py ${PROJECT_BINARY_DIR} DEPENDS impact-damper runs-exact
                  USES_TERMINAL VERBATIM)
foreach(group TheScan WhatDiffersIsNamed TheReferenceIsHeldAgainstTheNewOne RenewingTheReference TheChangelog)
  string(REGEX REPLACE "([a-z])([A-Z])" "\\1 \\2" words ${group})
  string(TOLOWER "same bits: ${words}" name)
  python_test(${name} regression same_bits/test_comparing.py ${group})
endforeach()

# What takes away what results rest on, from outside: each way is rejected, in words, with exit code 4.
set(embedding ${tests}/same_bits/embedding.cpp)
add_executable(embedding ${embedding})
# Linked, not compiled, with -ffast-math: the start-up code then sets the processor to flush denormal numbers.
add_executable(embedding_fast_link ${embedding})
target_link_options(embedding_fast_link PRIVATE -ffast-math)
set(embedding_programs embedding embedding_fast_link)
# An engine compiled with contraction: the library's own source with other flags, which is found before the library's.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(engine ${source}/src/impact_damper/engines/recorded_exact_free.cpp)
  set_source_files_properties(${engine} PROPERTIES COMPILE_OPTIONS "-O2;-mfma;-ffp-contract=fast")
  add_executable(embedding_contracting ${embedding} ${engine})
  target_compile_definitions(embedding_contracting PRIVATE NEEDS_FMA)
  list(APPEND embedding_programs embedding_contracting)
endif()
foreach(each IN LISTS embedding_programs)
  target_link_libraries(${each} PRIVATE impact_damper impact_damper_options)
endforeach()
add_library(embedding_upward MODULE same_bits/upward.cpp)

# rejected(NAME CODE WORDS COMMAND...): ends with CODE and says WORDS.
function(rejected name code words)
  command_test("same bits: ${name}" regression
               COMMAND sh -c [[code=$0 words=$1
                               shift
                               said=$("$@" 2>&1)
                               got=$?
                               echo "$said"
                               [ $got = 77 ] && exit 77
                               [ $got = "$code" ] && echo "$said" | grep -qF "$words" && exit 0
                               echo "exit code $got instead of $code, or not the words: $words"
                               exit 1]] ${code} ${words} ${ARGN})
endfunction()
rejected("a program that embeds the library and changes nothing is served" 0 "a run is done" $<TARGET_FILE:embedding>)
rejected("a program linked with fast-math is rejected" 4 "denormal numbers are flushed to zero"
        $<TARGET_FILE:embedding_fast_link>)
if(TARGET embedding_contracting)
  rejected("an engine compiled with contraction is rejected" 4 "products are fused with sums"
          $<TARGET_FILE:embedding_contracting>)
endif()
foreach(arguments "run --until-time 5" "series --catalogue none.json" "verify --runs none")
  separate_arguments(words UNIX_COMMAND "${arguments}")
  rejected("impact-damper ${arguments} is rejected with another rounding mode" 4 "the rounding mode is not to nearest"
          env LD_PRELOAD=$<TARGET_FILE:embedding_upward> ${program} ${words})
endforeach()
# Rejected while compiling.
set(flags -ffast-math -ffinite-math-only)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  list(APPEND flags -mfpmath=387)
endif()
foreach(flag IN LISTS flags)
  rejected("code compiled with ${flag} is rejected" 1 "results would not have the promised bits"
          ${CMAKE_CXX_COMPILER} -std=c++20 ${flag} -fsyntax-only -I${source}/src/include ${embedding})
endforeach()
