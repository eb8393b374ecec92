# SPDX-License-Identifier: Apache-2.0
# raycontact_library(TARGET NAME): the static library TARGET, complete by now, becomes raycontact::NAME. Our program and
# our tests link TARGET itself, whose inside they use. With BUILD_SHARED_LIBS users get another one of the same objects,
# TARGET_shared, which shows the public interface alone (raycontact/export.h); it is there for the tests in any case.
function(raycontact_library target name)
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
    if(NOT BUILD_SHARED_LIBS)
        add_library(raycontact::${name} ALIAS ${target})
    endif()
    if(NOT BUILD_SHARED_LIBS AND NOT RAYCONTACT_TESTS)
        return()
    endif()

    set(shared ${target}_shared)
    get_target_property(sources ${target} SOURCES)
    list(FILTER sources INCLUDE REGEX "TARGET_OBJECTS") # the kernels' objects: TARGET's own are only those it compiles
    add_library(${shared} SHARED $<TARGET_OBJECTS:${target}> ${sources})
    set_target_properties(${shared} PROPERTIES OUTPUT_NAME ${target} EXPORT_NAME ${name} LINKER_LANGUAGE CXX
        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}) # 0.x: a minor version may change the interface
    foreach(property INCLUDE_DIRECTORIES SYSTEM_INCLUDE_DIRECTORIES COMPILE_DEFINITIONS COMPILE_FEATURES)
        get_target_property(value ${target} INTERFACE_${property})
        if(value)
            set_property(TARGET ${shared} PROPERTY INTERFACE_${property} ${value})
        endif()
    endforeach()
    # What TARGET links, and what its users see of it; of ours the shared ones.
    get_target_property(linked ${target} LINK_LIBRARIES)
    get_target_property(seen ${target} INTERFACE_LINK_LIBRARIES)
    list(FILTER seen EXCLUDE REGEX "LINK_ONLY|BUILD_INTERFACE|NOTFOUND")
    list(TRANSFORM linked REPLACE "^(raycontact[a-z_]*)$" "\\1_shared")
    list(TRANSFORM seen REPLACE "^(raycontact[a-z_]*)$" "\\1_shared")
    target_link_libraries(${shared} PRIVATE ${linked} INTERFACE ${seen})
    if(UNIX AND NOT APPLE)
        # The instances of the standard library's templates are not ours to show.
        set(map ${PROJECT_SOURCE_DIR}/cmake/exports.map)
        target_link_options(${shared} PRIVATE LINKER:--version-script=${map})
        set_target_properties(${shared} PROPERTIES LINK_DEPENDS ${map})
    endif()
    if(BUILD_SHARED_LIBS)
        add_library(raycontact::${name} ALIAS ${shared})
    endif()
endfunction()
