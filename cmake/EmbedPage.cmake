# SPDX-License-Identifier: Apache-2.0
# The files of a web page as text in a generated header; never committed. Included, it defines
# raycontact_embed_page(target folder): the target may then include "page_text.h" (raycontact::page_files, by name).
# Run as a script (cmake -P), it writes the header.
if(NOT CMAKE_SCRIPT_MODE_FILE)
    set(raycontact_embed_page_script ${CMAKE_CURRENT_LIST_FILE})

    function(raycontact_embed_page target page_folder)
        set(folder ${CMAKE_CURRENT_SOURCE_DIR}/${page_folder})
        set(header ${CMAKE_CURRENT_BINARY_DIR}/page_text/page_text.h)
        file(GLOB files CONFIGURE_DEPENDS ${folder}/*)
        add_custom_command(OUTPUT ${header}
            COMMAND ${CMAKE_COMMAND} -D FOLDER=${folder} -D OUTPUT=${header} -P ${raycontact_embed_page_script}
            DEPENDS ${files} ${raycontact_embed_page_script}
            COMMENT "Embedding the page ${page_folder}" VERBATIM)
        target_sources(${target} PRIVATE ${header})
        target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/page_text)
    endfunction()
    return()
endif()

set(entries "")
file(GLOB files ${FOLDER}/*)
foreach(file ${files})
    get_filename_component(name ${file} NAME)
    file(READ ${file} text)
    # A compiler must accept 65536 characters in a literal, no more.
    string(LENGTH "${text}" length)
    if(length GREATER 60000)
        message(FATAL_ERROR "${file} is too long for one literal (${length} characters); split it")
    endif()
    string(APPEND entries "    {\"${name}\", R\"raycontact(${text})raycontact\"},\n")
endforeach()
file(WRITE ${OUTPUT} "// SPDX-License-Identifier: Apache-2.0
// Generated from ${FOLDER} by cmake/EmbedPage.cmake.
#pragma once

#include <string_view>

namespace raycontact {

struct PageFile {
    std::string_view name, text;
};

inline constexpr PageFile page_files[] = {
${entries}};

} // namespace raycontact
")
