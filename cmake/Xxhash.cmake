# SPDX-License-Identifier: Apache-2.0
# xxhash from its header alone, compiled in: whoever uses the installed library needs no xxhash.
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED DOC "Folder of xxhash.h")
mark_as_advanced(XXHASH_INCLUDE_DIR)

function(raycontact_use_xxhash target)
    target_compile_definitions(${target} PRIVATE XXH_INLINE_ALL)
    target_include_directories(${target} SYSTEM PRIVATE ${XXHASH_INCLUDE_DIR})
endfunction()
