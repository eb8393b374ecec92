# SPDX-License-Identifier: Apache-2.0
# cmake -DSOURCE=FOLDER -P system_headers.cmake: fails where the library, its recordings or the adapter include a header
# that is neither of the C++ standard, ours nor one of a library we use, or use what only some compilers have, outside
# the few files that may.
cmake_policy(VERSION 3.25)
set(system_files src/platform/system.cpp recording/file.cpp)
set(compiler_files include/raycontact/library_mode.h include/raycontact/export.h src/device/cpu/dialect.h src/device/cpu/instruction_set.h src/device/cpu/kernel_table.cpp
    src/executor/float_environment.h src/platform/prefetch.h adapters/bullet/src/prefetch.h)
set(dialects src/device/opencl/dialect.h src/device/cuda/dialect.h) # compiled on the device

set(known "[a-z0-9_]+" # the C++ standard's have no dot
    "(raycontact|recording|nlohmann|nanobind|oneapi/tbb|CL|LinearMath|BulletCollision|BulletDynamics|mujoco)/[A-Za-z0-9_./]+"
    "(Python|expat|unzip|xxhash|zlib)\\.h")
list(JOIN known "|" known)
set(posix "newlocale|uselocale|strto[a-z]+_l|ssize_t|off_t|mkstemp|getpid|usleep|localtime_r|gmtime_r|strerror_r|setenv|fileno|isatty|popen")
set(of_compilers "__builtin_|__attribute__|__restrict__|__int128|__typeof|__GNUC__|__clang__|_MSC_VER|__linux__|__GLIBC__|[^a-z_]gnu::")

set(faults "")
file(GLOB_RECURSE files RELATIVE ${SOURCE} ${SOURCE}/include/*.h ${SOURCE}/src/*.h ${SOURCE}/src/*.cpp ${SOURCE}/src/*.def
    ${SOURCE}/recording/*.h ${SOURCE}/recording/*.cpp ${SOURCE}/adapters/*.h ${SOURCE}/adapters/*.cpp)
list(LENGTH files count)
if(count LESS 100)
    message(FATAL_ERROR "only ${count} files found in ${SOURCE}")
endif()
foreach(file ${files})
    if(file IN_LIST dialects OR file IN_LIST system_files)
        continue()
    endif()
    file(STRINGS ${SOURCE}/${file} lines REGEX "#[ ]*include[ ]*<|${posix}|${of_compilers}|_WIN32")
    foreach(line ${lines})
        string(REGEX REPLACE "//.*" "" code "${line}")
        if(code MATCHES "#[ ]*include[ ]*<([^>]+)>")
            set(header ${CMAKE_MATCH_1})
            get_filename_component(folder ${file} DIRECTORY)
            if(NOT header MATCHES "^(${known})$" AND NOT EXISTS ${SOURCE}/${folder}/${header}
               AND NOT (file IN_LIST compiler_files AND header MATCHES "^([a-z]*mm)?intrin\\.h$"))
                list(APPEND faults "${file} includes <${header}>")
            endif()
        elseif(code MATCHES "(^|[^A-Za-z0-9_])(${posix})($|[^A-Za-z0-9_])")
            list(APPEND faults "${file} uses ${CMAKE_MATCH_2}, which is POSIX's")
        elseif(code MATCHES "_WIN32" AND NOT file MATCHES "^(src/platform/system|include/raycontact/export)\\.h$")
            list(APPEND faults "${file} asks for _WIN32")
        elseif(code MATCHES "(${of_compilers})" AND NOT file IN_LIST compiler_files)
            list(APPEND faults "${file} uses ${CMAKE_MATCH_1}, which not every compiler has")
        endif()
    endforeach()
endforeach()
if(faults)
    list(JOIN faults "\n  " faults)
    list(JOIN system_files ", " places)
    message(FATAL_ERROR "Only ${places} ask the system for something:\n  ${faults}")
endif()
