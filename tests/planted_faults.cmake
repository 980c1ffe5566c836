# verify must notice a wrong model. In a copy of the sources in FOLDER one fault after the other is planted and all
# runs are made again. Then the verdicts must differ from the recorded ones, or verify must reject a run that
# contradicts itself; without a fault they must be as recorded.
#
#   cmake -DSOURCE=... -DFOLDER=... -P planted_faults.cmake
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE ${FOLDER})
foreach(part CMakeLists.txt src data figures paper)
  file(COPY ${SOURCE}/${part} DESTINATION ${FOLDER})
endforeach()

function(run)
  execute_process(COMMAND ${ARGV} WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE code OUTPUT_VARIABLE out
                  ERROR_VARIABLE out)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGV}: exit code ${code}\n${out}")
  endif()
endfunction()

# verdicts(CODE NAME SAID): builds, runs the scenes, verifies, which must end with CODE and say what matches SAID.
function(verdicts wanted name said)
  run(${CMAKE_COMMAND} --build build --target runs-exact)
  execute_process(COMMAND build/src/impact-damper verify --members 8 WORKING_DIRECTORY ${FOLDER}
                  RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
  string(REGEX MATCH "[^\n]*${said}[^\n]*" summary "${out}\n${err}")
  message("${name}: exit code ${code}; ${summary}")
  if(NOT code EQUAL wanted OR summary STREQUAL "")
    message(FATAL_ERROR "${name}: exit code ${code} instead of ${wanted}\n${out}\n${err}")
  endif()
endfunction()

# plant(NAME FILE FROM TO [FROM2 TO2]): verify with FROM in FILE replaced by TO must end with the code CODE and say
# SAID.
function(replaced text name file from to)
  string(REPLACE "${from}" "${to}" result "${${text}}")
  if(result STREQUAL "${${text}}")
    message(FATAL_ERROR "${name}: ${file} no longer holds what is to be replaced:\n${from}")
  endif()
  set(${text} "${result}" PARENT_SCOPE)
endfunction()
function(plant name file from to)
  set(path ${FOLDER}/src/${file})
  file(READ ${path} sound)
  set(faulty "${sound}")
  replaced(faulty ${name} ${file} "${from}" "${to}")
  if(ARGC GREATER 4)
    replaced(faulty ${name} ${file} "${ARGV4}" "${ARGV5}")
  endif()
  file(WRITE ${path} "${faulty}")
  verdicts(${CODE} ${name} "${SAID}")
  file(WRITE ${path} "${sound}")
endfunction()

run(${CMAKE_COMMAND} -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS=-O1 -DPYTHON_MODULE=OFF)
verdicts(0 "no fault" "claims:")

set(CODE 1)
set(SAID "claims:")

plant("loss factor per cycle" impact_damper/analysis/loss_factor.cpp
      "loss.eta.push_back(-2 *"
      "loss.eta.push_back(-2 * 2 * std::numbers::pi *")
# A wall that cannot pull: contact ends where its force c q' + K q vanishes. What impacts take of the energy then
# is not what the force puts in.
set(CODE 3)
set(SAID "contradicts the rest of the response")
plant("contact force clipped at zero" include/impact_damper/motion/contact.hpp
      "    if (start_.y == wall_ && (start_.w != 0 || pressed_until() == 0)) {
      std::optional<End> end;"
      "    if (false) {
      std::optional<End> end;"
      "[&](const Real& t) { return depth(t, search.span); }"
      "[&](const Real& t) -> LocalEnclosure<Real> {
      const auto now = Motion::instants_of_q(t);
      const auto force = [&](std::size_t n) -> Real {
        return inward_ * (system_.stiffness * (now.slow[n] + now.fast[n]) +
                          system_.damping * (now.slow[n + 1] + now.fast[n + 1]));
      };
      const Real span = search.span;
      const Real third = system_.stiffness * (now.slow.bound(3, span) + now.fast.bound(3, span)) +
                         system_.damping * (now.slow.bound(4, span) + now.fast.bound(4, span));
      return {{force(0), force(1), force(2), third}, {}, std::numeric_limits<Real>::infinity()};
    }")
set(CODE 1)
set(SAID "claims:")
# Last, as most is compiled anew with this header: it need not be put right for another.
plant("restitution off by 0.05" include/impact_damper/motion/wall.hpp
      "-logarithm(restitution)"
      "-logarithm(Real(restitution - Real(0.05)))")
