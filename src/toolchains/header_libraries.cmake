# For compilers of other machines: Eigen, CLI11 and nlohmann-json, which are headers only, copied out of /usr/include.
# There they lie beside the headers of this machine's C library, which no other machine may be compiled with.
set(header_libraries ${CMAKE_BINARY_DIR}/header_libraries)
get_property(trial GLOBAL PROPERTY IN_TRY_COMPILE)
if(NOT trial)
  file(COPY /usr/include/eigen3 /usr/include/CLI /usr/include/nlohmann DESTINATION ${header_libraries}/usr/include)
  file(GLOB packages /usr/share/eigen3/cmake /usr/*/cmake/CLI11 /usr/*/cmake/nlohmann_json)
  foreach(package IN LISTS packages)
    cmake_path(GET package PARENT_PATH folder)
    file(COPY ${package} DESTINATION ${header_libraries}${folder})
  endforeach()
endif()
list(APPEND CMAKE_FIND_ROOT_PATH ${header_libraries})
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
# What is compiled for this machine is of no use there.
set(CMAKE_DISABLE_FIND_PACKAGE_HDF5 ON)
set(PYTHON_MODULE OFF CACHE BOOL "")
