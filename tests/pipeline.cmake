# One CASE of the figure stage in FOLDER, made anew: scene -> run -> table -> picture, with PROGRAM and the
# scripts of FIGURES. Every case but the first two breaks one link and expects the failure to name figure and
# file, and to leave no table or picture behind.
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${FOLDER})
# file(COPY) takes files with equal time stamps for the same, as those of one checkout may have.
file(COPY ${FIGURES}/ DESTINATION ${FOLDER}/figures PATTERN catalogue.json EXCLUDE)
file(WRITE ${FOLDER}/figures/small.json [[
{
  "description": "The last tenth of the base case's decay",
  "x0": 0.6,
  "until_time": 400,
  "until_amplitude": 0.03
}
]])
file(WRITE ${FOLDER}/figures/catalogue.json [[
{
  "schema": "impact-damper/catalogue/1",
  "scenes": [
    {"scene": "small", "record": ["half_cycles", "impacts", "contacts", "history"],
     "history_below": [{"amplitude": 0.2, "length": 12, "count": 200}]}
  ],
  "figures": [
    {"figure": "5", "title": "Motion", "table": "motion", "window": 0.2, "curves": [{"scene": "small"}],
     "script": "fig05.gp"},
    {"figure": "8", "title": "It's a loss factor", "table": "loss_factor", "ordinate": "eta", "down_to": 0.1,
     "curves": [{"scene": "small"}], "script": "single.gp"}
  ]
}
]])
file(WRITE ${FOLDER}/figures/single.gp [[
from = 0.03
styles = "1"
theory = "1"
logarithmic = "xy"
ordinate = "η"
set ylabel "loss factor ".ordinate
load folder."/loss.gp"
]])
file(MAKE_DIRECTORY ${FOLDER}/runs ${FOLDER}/series ${FOLDER}/pictures)

# step(COMMAND...): in FOLDER; sets `code` and `err`.
macro(step)
  execute_process(COMMAND ${ARGV} WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE code OUTPUT_VARIABLE out
                  ERROR_VARIABLE err TIMEOUT 60)
endmacro()
macro(succeed)
  step(${ARGV})
  if(NOT code EQUAL 0 OR NOT err STREQUAL "")
    message(FATAL_ERROR "${ARGV}: exit code ${code}: ${err}")
  endif()
endmacro()
# expect(CODE TEXT...): the step before failed like this.
function(expect wanted)
  if(NOT code EQUAL wanted)
    message(FATAL_ERROR "exit code ${code} instead of ${wanted}: ${err}")
  endif()
  foreach(text IN LISTS ARGN)
    string(FIND "${err}" "${text}" found)
    if(found EQUAL -1)
      message(FATAL_ERROR "stderr does not say \"${text}\": ${err}")
    endif()
  endforeach()
endfunction()
function(expect_none pattern)
  file(GLOB left ${FOLDER}/${pattern} ${FOLDER}/pictures/.*)
  if(left)
    message(FATAL_ERROR "left behind: ${left}")
  endif()
endfunction()

set(run ${PROGRAM} run --scene figures/small.json --record half_cycles,impacts,contacts,history
        --history-below 0.2:12:200 -o runs/small.json)
set(series ${PROGRAM} series --catalogue figures/catalogue.json --runs runs --scenes figures)
set(all_tables ${series} -o series)
set(draw figures/draw figures/single.gp series/single.dat "It's a loss factor")

if(CASE STREQUAL missing_run)
  step(${series} --figure 8 -o series/single.dat)
  expect(5 "figure 8: runs/small.json: ")
  expect_none(series/*)
  return()
elseif(CASE STREQUAL short_run)
  file(WRITE ${FOLDER}/figures/small.json "{\"x0\": 0.3, \"until_time\": 20, \"until_amplitude\": 0.03}")
  step(${run})
  expect(0 "history has 0 of the 200 samples asked for")
  step(${series} --figure 8 -o series/single.dat)
  expect(3 "figure 8: runs/small.json: is too short")
  step(${series} --figure 5 -o series/fig05.dat)
  expect(3 "figure 5: runs/small.json: is too short")
  expect_none(series/*)
  return()
endif()

succeed(${run})
if(CASE STREQUAL run_without_number)
  # JSON has no NaN; what a writer would make of one is null.
  file(READ ${FOLDER}/runs/small.json text)
  string(REGEX REPLACE "\"amplitude\": \\[[^,]*," "\"amplitude\": [null," text "${text}")
  file(WRITE ${FOLDER}/runs/small.json "${text}")
  step(${series} --figure 8 -o series/single.dat)
  expect(3 "figure 8: runs/small.json: " "/half_cycles/amplitude/0")
  expect_none(series/*)
  return()
endif()
succeed(${all_tables})

if(CASE STREQUAL draws)
  succeed(figures/draw figures/fig05.gp series/fig05.dat Motion pictures/fig05 9.8.7)
  succeed(${draw} pictures/fig08 9.8.7)
  foreach(picture fig05.svg fig05.pdf fig05.png fig08.svg fig08.pdf fig08.png)
    file(SIZE ${FOLDER}/pictures/${picture} size)
    if(size LESS 5000)
      message(FATAL_ERROR "${picture} has only ${size} bytes")
    endif()
  endforeach()
  file(READ ${FOLDER}/pictures/fig08.svg text)
  # Words that stand in the picture are pieces of a text, in which the symbols are in italics.
  string(REGEX REPLACE "</?tspan[^>]*>" "" text "${text}")
  foreach(words "<title>It's a loss factor: ν = 2 %, e = 0.6, ζ = 0</title>" "closed forms, ν → 0" "loss factor η")
    string(FIND "${text}" "${words}" found)
    if(found EQUAL -1)
      message(FATAL_ERROR "the picture does not say \"${words}\"")
    endif()
  endforeach()
  # The stamp and where the axes are, in words and for programs.
  file(SHA256 ${FOLDER}/series/single.dat sum)
  string(SUBSTRING ${sum} 0 8 digits)
  if(NOT text MATCHES "<text [^>]*>${digits} · 9\\.8\\.7</text>")
    message(FATAL_ERROR "the picture does not carry the stamp ${digits} · 9.8.7")
  endif()
  string(REGEX MATCH "<metadata>(.*)</metadata>" metadata "${text}")
  string(JSON stamp GET "${CMAKE_MATCH_1}" stamp)
  string(JSON name GET "${CMAKE_MATCH_1}" axes 0 x 0)
  string(JSON logarithmic GET "${CMAKE_MATCH_1}" axes 0 log)
  if(NOT "${stamp} ${name} ${logarithmic}" STREQUAL "${digits} · 9.8.7 A xy")
    message(FATAL_ERROR "the picture's metadata: ${CMAKE_MATCH_1}")
  endif()
  string(REGEX MATCHALL "(id=|href=|url\\()['\"#]*[a-z]+" names "${text}")
  list(FILTER names EXCLUDE REGEX "fig$")
  if(names)
    message(FATAL_ERROR "names that another figure on the same page may have: ${names}")
  endif()
elseif(CASE STREQUAL repeats)
  file(MAKE_DIRECTORY ${FOLDER}/pictures/first ${FOLDER}/pictures/second)
  succeed(${draw} pictures/first/fig08 9.8.7)
  succeed(${CMAKE_COMMAND} -E sleep 1)  # so that a time of day, which formats note in seconds, is another one
  succeed(${run})
  succeed(${all_tables})
  succeed(${CMAKE_COMMAND} -E sleep 1)  # so that a date with seconds in it, as a PDF carries, would be another one
  succeed(${draw} pictures/second/fig08 9.8.7)
  foreach(format svg pdf png)
    succeed(${CMAKE_COMMAND} -E compare_files pictures/first/fig08.${format} pictures/second/fig08.${format})
  endforeach()
elseif(CASE STREQUAL missing_table)
  file(REMOVE ${FOLDER}/series/single.dat)
  step(${draw} pictures/fig08 9.8.7)
  expect(1 "fig08: series/single.dat: is missing")
  expect_none(pictures/*)
elseif(CASE STREQUAL nan_in_table)
  file(READ ${FOLDER}/series/single.dat text)
  string(REGEX REPLACE "\n(0\\.[0-9]+) [^\n]*\n" "\n\\1 nan\n" text "${text}")
  file(WRITE ${FOLDER}/series/single.dat "${text}")
  step(${draw} pictures/fig08 9.8.7)
  expect(1 "fig08: series/single.dat: " "curve-1")
  expect_none(pictures/*)
elseif(CASE STREQUAL lost_curve)
  file(READ ${FOLDER}/series/single.dat text)
  string(REPLACE "# curve-1\n" "# curve-2\n" text "${text}")
  file(WRITE ${FOLDER}/series/single.dat "${text}")
  step(${draw} pictures/fig08 9.8.7)
  expect(1 "fig08: series/single.dat: ")
  expect_none(pictures/*)
elseif(CASE STREQUAL broken_script)
  file(APPEND ${FOLDER}/figures/single.gp "plot table index 'nothing' using 1:2\n")
  step(${draw} pictures/fig08 9.8.7)
  expect(1 "fig08: series/single.dat: gnuplot")
  expect_none(pictures/*)
elseif(CASE STREQUAL gnuplot_draws_nothing)
  file(WRITE ${FOLDER}/bin/gnuplot "#!/bin/sh\nexit 0\n")
  file(CHMOD ${FOLDER}/bin/gnuplot PERMISSIONS OWNER_READ OWNER_EXECUTE)
  step(${CMAKE_COMMAND} -E env "PATH=${FOLDER}/bin:$ENV{PATH}" ${draw} pictures/fig08 9.8.7)
  if(NOT "${code} ${err}" STREQUAL "1 fig08: series/single.dat: gnuplot left no whole picture\n")
    message(FATAL_ERROR "exit code ${code}: ${err}")
  endif()
  expect_none(pictures/*)
elseif(CASE STREQUAL complaining_script)
  # The picture is whole and the exit code 0, as when one of several curves has no valid point.
  file(APPEND ${FOLDER}/figures/single.gp "printerr 'one curve has no valid point'\n")
  step(${draw} pictures/fig08 9.8.7)
  expect(1 "fig08: series/single.dat: gnuplot complains: one curve has no valid point")
  expect_none(pictures/*)
else()
  message(FATAL_ERROR "no such case: ${CASE}")
endif()
