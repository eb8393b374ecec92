# SPDX-License-Identifier: Apache-2.0
# Installs and exports raycontact::raycontact, raycontact::recording and raycontact::bullet where they are built, and the
# program.
option(RAYCONTACT_INSTALL "Make install rules" ${PROJECT_IS_TOP_LEVEL})
if(NOT RAYCONTACT_INSTALL)
    return()
endif()
include(CMakePackageConfigHelpers)

set(raycontact_config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/raycontact)
set(raycontact_kind "")
if(BUILD_SHARED_LIBS)
    set(raycontact_kind _shared)
endif()
# raycontact_install(TARGET EXPORT HEADERS): a library as users get it (cmake/Library.cmake), and its headers.
function(raycontact_install target export headers)
    install(TARGETS ${target}${raycontact_kind} EXPORT ${export}
        RUNTIME COMPONENT runtime LIBRARY COMPONENT runtime NAMELINK_COMPONENT development ARCHIVE COMPONENT development)
    install(DIRECTORY ${headers}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
endfunction()
raycontact_install(raycontact raycontactTargets ${PROJECT_SOURCE_DIR}/include)
install(EXPORT raycontactTargets NAMESPACE raycontact:: DESTINATION ${raycontact_config_folder} COMPONENT development)
set(RAYCONTACT_HAS_RECORDING OFF)
if(TARGET raycontact_recording)
    set(RAYCONTACT_HAS_RECORDING ON)
    raycontact_install(raycontact_recording raycontactTargets ${PROJECT_SOURCE_DIR}/recording/include)
endif()
# In an export set of its own: the core is of use where Bullet is not installed.
set(RAYCONTACT_HAS_BULLET OFF)
if(TARGET raycontact_bullet)
    set(RAYCONTACT_HAS_BULLET ON)
    raycontact_install(raycontact_bullet raycontactBulletTargets ${PROJECT_SOURCE_DIR}/adapters/bullet/include)
    install(EXPORT raycontactBulletTargets NAMESPACE raycontact:: DESTINATION ${raycontact_config_folder} COMPONENT development)
endif()
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/raycontactConfig.cmake.in
    ${PROJECT_BINARY_DIR}/raycontactConfig.cmake INSTALL_DESTINATION ${raycontact_config_folder})
# 0.x: a new minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/raycontactConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/raycontactConfig.cmake ${PROJECT_BINARY_DIR}/raycontactConfigVersion.cmake
    DESTINATION ${raycontact_config_folder} COMPONENT development)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
    DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT development)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT development PATTERN "*.py" EXCLUDE) # and its examples
if(TARGET raycontact_cli)
    install(TARGETS raycontact_cli RUNTIME COMPONENT program)
endif()
if(PROJECT_IS_TOP_LEVEL)
    include(cmake/Package.cmake)
endif()
