# find_package(impact_damper): the target impact_damper::impact_damper.
include(CMakeFindDependencyMacro)
set(THREADS_PREFER_PTHREAD_FLAG ON)
find_dependency(Threads)
include(${CMAKE_CURRENT_LIST_DIR}/impact_damper-targets.cmake)
