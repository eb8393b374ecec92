# SPDX-License-Identifier: Apache-2.0
# Warnings and float rules for our own targets; nothing of this reaches a user of the library.
function(raycontact_strict target)
    target_compile_features(${target} PUBLIC cxx_std_20)
    set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
    if(MSVC)
        # /fp:precise does not contract; clang-cl, which takes the same options, needs to be told. Warnings stay
        # warnings: nobody has read this compiler's yet.
        target_compile_options(${target} PRIVATE /W4 /permissive- /utf-8 /Zc:__cplusplus /Zc:preprocessor /fp:precise
            $<$<CXX_COMPILER_ID:Clang>:/clang:-ffp-contract=off>)
        target_compile_definitions(${target} PRIVATE _CRT_SECURE_NO_WARNINGS NOMINMAX)
        return()
    endif()
    # No contraction anywhere: one fused multiply-add changes a bit, and a bit changes the hash.
    target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -ffp-contract=off)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
        # A user of clang++ may have it on, and our headers are not always system headers.
        target_compile_options(${target} PRIVATE -Wextra-semi)
    endif()
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        # g++ 12 loses the rounding of double -> float -> double when it vectorises such conversions side by side.
        target_compile_options(${target} PRIVATE -fno-tree-slp-vectorize)
    endif()
    if(RAYCONTACT_STRICT)
        target_compile_options(${target} PRIVATE -Werror)
    elseif(NOT PROJECT_IS_TOP_LEVEL)
        # The warnings that a project around this one asks for are about its own code: our sources give none there,
        # and our headers are those of a system library.
        target_compile_options(${target} PRIVATE -w)
        set_target_properties(${target} PROPERTIES COMPILE_WARNING_AS_ERROR OFF SYSTEM ON)
    endif()
endfunction()
