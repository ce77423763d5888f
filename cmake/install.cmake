# cmake --install: the programs (thimble_program), what comes with them, and the libraries that other programs can link by
# find_package(thimble). docs/install.md says how; examples/ does it.
include(CMakePackageConfigHelpers)
set(THIMBLE_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/thimble)
set(THIMBLE_HEADER_DIR ${CMAKE_INSTALL_INCLUDEDIR}/thimble)

# thimble_export(target name folders...): installs a library as thimble::NAME, with the headers of these folders.
function(thimble_export target name)
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
    # Includes are written from the project's root, which is include/thimble for others.
    target_include_directories(${target} INTERFACE $<INSTALL_INTERFACE:${THIMBLE_HEADER_DIR}>)
    target_compile_features(${target} INTERFACE $<INSTALL_INTERFACE:cxx_std_20>)
    target_compile_definitions(${target} INTERFACE $<INSTALL_INTERFACE:THIMBLE_VERSION="${PROJECT_VERSION}">)
    install(TARGETS ${target} EXPORT thimble ARCHIVE COMPONENT development)
    foreach(FOLDER ${ARGN})
        install(DIRECTORY ${PROJECT_SOURCE_DIR}/${FOLDER}/ DESTINATION ${THIMBLE_HEADER_DIR}/${FOLDER} COMPONENT development
            FILES_MATCHING PATTERN *.hpp PATTERN controller.h PATTERN runtime EXCLUDE PATTERN ros2 EXCLUDE PATTERN import EXCLUDE PATTERN relay EXCLUDE PATTERN shell EXCLUDE PATTERN commands EXCLUDE)
    endforeach()
endfunction()
thimble_export(thimble_common common common)
thimble_export(thimble_netem netem netem)
thimble_export(thimble_slave_sim tissue slave_sim)
thimble_export(thimble_statistics statistics analysis/statistics)
thimble_export(thimble_stability stability stability)

# The interface of controllers alone, for a plug-in: <thimble/controller.h>.
install(FILES common/control/controller.h DESTINATION ${THIMBLE_HEADER_DIR} COMPONENT development)

# The wire schema: as text for other languages, and as the header that flatc made of it. That one insists on the FlatBuffers
# version it was made with.
install(FILES common/messages.fbs DESTINATION ${CMAKE_INSTALL_DATADIR}/thimble COMPONENT development)
install(FILES ${CMAKE_BINARY_DIR}/common/generated/messages_generated.h DESTINATION ${THIMBLE_HEADER_DIR}
    COMPONENT development)

install(EXPORT thimble NAMESPACE thimble:: FILE thimble-targets.cmake DESTINATION ${THIMBLE_PACKAGE_DIR}
    COMPONENT development)
configure_package_config_file(cmake/thimble-config.cmake.in ${CMAKE_BINARY_DIR}/thimble-config.cmake
    INSTALL_DESTINATION ${THIMBLE_PACKAGE_DIR} PATH_VARS CMAKE_INSTALL_DATADIR)
# Before 1.0 each minor version may change what it offers.
write_basic_package_version_file(${CMAKE_BINARY_DIR}/thimble-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/thimble-config.cmake ${CMAKE_BINARY_DIR}/thimble-config-version.cmake
    DESTINATION ${THIMBLE_PACKAGE_DIR} COMPONENT development)

# Programs find the sessions by name beside the folder they lie in, installed or not.
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/share/thimble)
foreach(FOLDER board schema sessions)
    file(CREATE_LINK ${PROJECT_SOURCE_DIR}/deploy/${FOLDER} ${CMAKE_BINARY_DIR}/share/thimble/${FOLDER} SYMBOLIC)
endforeach()
# Session files, scenes and networks to begin with.
install(DIRECTORY deploy/board deploy/pages deploy/profiles deploy/scenes deploy/schema deploy/sessions DESTINATION ${CMAKE_INSTALL_DATADIR}/thimble
    COMPONENT programs)
# The page for a browser (thimble play --browser), where deploy/browser has built it.
install(FILES build/browser/thimble.html DESTINATION ${CMAKE_INSTALL_DATADIR}/thimble COMPONENT programs OPTIONAL)
if(THIMBLE_GUI)
    install(FILES deploy/desktop/thimble.desktop deploy/desktop/thimble-experimenter.desktop
        DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT programs)
    install(FILES deploy/desktop/thimble.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps
        COMPONENT programs)
    install(FILES deploy/desktop/io.github.thimble.Thimble.metainfo.xml
        DESTINATION ${CMAKE_INSTALL_DATADIR}/metainfo COMPONENT programs)
endif()
