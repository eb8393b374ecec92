# SPDX-License-Identifier: Apache-2.0
# The kernels' text for compilers that run later: one dialect, the types, every kernel that runs on all devices and the
# scan, in pieces in a generated header; never committed. Included, it defines raycontact_embed_kernels(target
# DIALECT...): the target may then include "kernels_<dialect>.h" (raycontact::opencl_pieces, raycontact::cuda_pieces).
# Run as a script (cmake -P), it writes one of them.
if(NOT CMAKE_SCRIPT_MODE_FILE)
    set(raycontact_embed_script ${CMAKE_CURRENT_LIST_FILE})

    function(raycontact_embed_kernels target)
        set(source_folder ${PROJECT_SOURCE_DIR}/src)
        set(folder ${CMAKE_CURRENT_BINARY_DIR}/kernels_text)
        file(GLOB kernels CONFIGURE_DEPENDS ${source_folder}/kernels/*.h ${source_folder}/device/gpu/*.h)
        foreach(dialect ${ARGN})
            set(header ${folder}/kernels_${dialect}.h)
            add_custom_command(OUTPUT ${header}
                COMMAND ${CMAKE_COMMAND} -D SOURCE_FOLDER=${source_folder} -D DIALECT=${dialect} -D OUTPUT=${header}
                        -P ${raycontact_embed_script}
                DEPENDS ${kernels} ${source_folder}/device/${dialect}/dialect.h ${raycontact_embed_script}
                COMMENT "Embedding the kernels for ${dialect}" VERBATIM)
            target_sources(${target} PRIVATE ${header})
        endforeach()
        target_include_directories(${target} PRIVATE ${folder})
    endfunction()
    return()
endif()

# A stretch of one file as a raw string, or as several: Microsoft's compiler takes 16380 characters in one.
function(add_piece text first_line file)
    string(LENGTH "${text}" length)
    while(length GREATER 16300)
        string(SUBSTRING "${text}" 0 16300 begin)
        string(FIND "${begin}" "\n" at REVERSE)
        math(EXPR at "${at} + 1")
        string(SUBSTRING "${text}" 0 ${at} begin)
        string(SUBSTRING "${text}" ${at} -1 text)
        string(APPEND pieces "    {\"${file}\", R\"raycontact(#line ${first_line} \"${file}\"\n${begin})raycontact\"},\n")
        string(REGEX REPLACE "[^\n]" "" newlines "${begin}")
        string(LENGTH "${newlines}" lines)
        math(EXPR first_line "${first_line} + ${lines}")
        string(LENGTH "${text}" length)
    endwhile()
    if(NOT text STREQUAL "")
        string(APPEND pieces "    {\"${file}\", R\"raycontact(#line ${first_line} \"${file}\"\n${text})raycontact\"},\n")
    endif()
    set(pieces "${pieces}" PARENT_SCOPE)
endfunction()

# The text of a file with its includes resolved; #line marks let a compiler's message name the file it came from.
function(embed file)
    file(READ ${SOURCE_FOLDER}/${file} rest)
    set(line 1)
    while(rest MATCHES "(^|\n)#include \"([^\"]+)\"\n")
        set(included ${CMAKE_MATCH_2})
        string(FIND "${rest}" "#include \"${included}\"\n" at)
        string(SUBSTRING "${rest}" 0 ${at} before)
        string(LENGTH "#include \"${included}\"\n" length)
        math(EXPR after "${at} + ${length}")
        string(SUBSTRING "${rest}" ${after} -1 rest)
        add_piece("${before}" ${line} ${file})
        string(REGEX REPLACE "[^\n]" "" newlines "${before}")
        string(LENGTH "${newlines}" lines)
        math(EXPR line "${line} + ${lines} + 1")
        embed(${included})
    endwhile()
    add_piece("${rest}" ${line} ${file})
    set(pieces "${pieces}" PARENT_SCOPE)
endfunction()

set(pieces "")
embed(device/${DIALECT}/dialect.h)
embed(kernels/types.h)
embed(kernels/kernels.h)
embed(device/gpu/scan.h)
embed(device/gpu/probe.h)
embed(device/gpu/probe_double.h)
file(WRITE ${OUTPUT} "// SPDX-License-Identifier: Apache-2.0
// Generated from src/device/${DIALECT}/dialect.h, src/kernels and src/device/gpu by cmake/EmbedKernels.cmake.
#pragma once

#include \"device/kernel_text.h\"

namespace raycontact {

inline constexpr KernelPiece ${DIALECT}_pieces[] = {
${pieces}};

} // namespace raycontact
")
