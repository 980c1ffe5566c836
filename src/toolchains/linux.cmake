# Another processor's Linux, by Debian's cross compilers: MACHINE is aarch64, riscv64 or s390x. Its programs hold all
# they need, so qemu runs them here without that machine's libraries.
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES MACHINE)
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR ${MACHINE})
set(CMAKE_CXX_COMPILER ${MACHINE}-linux-gnu-g++)
set(CMAKE_EXE_LINKER_FLAGS_INIT -static)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
include(${CMAKE_CURRENT_LIST_DIR}/header_libraries.cmake)
