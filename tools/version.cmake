# Writes common/core/version.h, and leaves it alone where nothing changed.
# usage: cmake -D PROJECT_VERSION=… -D CMAKE_BUILD_TYPE=… -D SOURCE=… -D OUTPUT=… -P tools/version.cmake
find_package(Git QUIET)
set(SKINBENCH_REVISION unknown)
if(GIT_FOUND)
    execute_process(COMMAND ${GIT_EXECUTABLE} -c safe.directory=* describe --always --dirty
        WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(revision)
        set(SKINBENCH_REVISION ${revision})
    endif()
endif()
configure_file(${SOURCE}/common/core/version.h.in ${OUTPUT} @ONLY)
