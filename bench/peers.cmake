# The peers whose packages are there, for the bench's program alone; each sees only its own libraries.

# peer(NAME FILES LIBRARIES...): compiled apart, with warnings of foreign templates off.
function(peer name files)
  add_library(bench_${name} OBJECT EXCLUDE_FROM_ALL ${files})
  target_include_directories(bench_${name} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/src/include)
  target_link_libraries(bench_${name} PRIVATE impact_damper_options ${ARGN})
  target_compile_options(bench_${name} PRIVATE -Wno-missing-field-initializers)
  target_sources(impact-damper-bench PRIVATE $<TARGET_OBJECTS:bench_${name}>)
  string(TOUPPER ${name} upper)
  target_compile_definitions(impact-damper-bench PRIVATE HAVE_${upper})
  target_link_libraries(impact-damper-bench PRIVATE ${ARGN})
endfunction()

find_path(ODEINT_HEADERS boost/numeric/odeint.hpp)
if(ODEINT_HEADERS)
  peer(odeint "peers/odeint.cpp;peers/odeint_dampers.cpp;peers/odeint_reference.cpp")
  # odeint copies steppers whose scratch arrays were never written.
  target_compile_options(bench_odeint PRIVATE -Wno-uninitialized -Wno-maybe-uninitialized)
  if(HAVE_FLOAT128)
    target_compile_definitions(bench_odeint PRIVATE HAVE_FLOAT128)
  endif()
endif()

find_package(SUNDIALS 6 QUIET COMPONENTS cvode arkode nvecserial sunnonlinsolfixedpoint)
if(SUNDIALS_FOUND)
  peer(sundials "peers/cvode.cpp;peers/arkode.cpp" SUNDIALS::cvode SUNDIALS::arkode SUNDIALS::nvecserial
       SUNDIALS::sunnonlinsolfixedpoint)
endif()

# Its own CMake package wants the rest of Siconos too.
find_path(SICONOS_HEADERS siconos/kernel/SiconosKernel.hpp)
find_library(SICONOS_KERNEL siconos_kernel)
find_library(SICONOS_NUMERICS siconos_numerics)
if(SICONOS_HEADERS AND SICONOS_KERNEL AND SICONOS_NUMERICS)
  peer(siconos peers/siconos.cpp ${SICONOS_KERNEL} ${SICONOS_NUMERICS})
  set(headers ${SICONOS_HEADERS}/siconos)
  target_include_directories(bench_siconos SYSTEM PRIVATE ${headers} ${headers}/kernel ${headers}/numerics
                             /usr/include/suitesparse)
  set_target_properties(bench_siconos PROPERTIES CXX_STANDARD 17)  # Boost.uBLAS is not for C++20
endif()

foreach(name odeint sundials siconos)
  if(NOT TARGET bench_${name})
    message(STATUS "Bench: without ${name}; `make deps-bench` installs it")
  endif()
endforeach()
