# WebAssembly, by Debian's emscripten.
include(/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/header_libraries.cmake)
set(CMAKE_CXX_FLAGS_INIT "-fwasm-exceptions -include ${CMAKE_CURRENT_LIST_DIR}/standard_library.hpp")
set(CMAKE_EXE_LINKER_FLAGS_INIT -fwasm-exceptions)
# CMake's own switch for link-time optimisation takes a form of it that Debian has no libraries for. At -Os emscripten
# forbids to inline functions: a tenth smaller, and a decay takes three times as long.
set(CMAKE_CXX_FLAGS_MINSIZEREL_INIT "-flto -finline-functions")
# emscripten's linker runs node, which finds Debian's acorn here; Debian's own node knows, others do not.
set(ENV{NODE_PATH} /usr/share/nodejs)
set(CMAKE_CXX_LINKER_LAUNCHER ${CMAKE_COMMAND} -E env NODE_PATH=/usr/share/nodejs)
