# One interface library carries every flag, so that no target can forget one. It is not installed: who links an installed
# library gets C++20 and the headers (cmake/install.cmake), not our warnings.
add_library(thimble_options INTERFACE)
target_include_directories(thimble_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_definitions(thimble_options INTERFACE THIMBLE_VERSION="${PROJECT_VERSION}")
# -ffp-contract=off: the same bits from every compiler and build type, which seeds and golden files rely on.
target_compile_options(thimble_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
    -Wno-sign-conversion -Wdouble-promotion -Wnon-virtual-dtor -Werror -ffp-contract=off)
# Half a gigabyte before g++ begins to tidy its memory: a twelfth of its time. (The word after it is for clang's tools that
# read g++'s commands; g++ passes over what it does not know of -Wno-.)
target_compile_options(thimble_options INTERFACE
    "$<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=524288;-Wno-unused-command-line-argument>")
# The Python module is a shared library that holds the rooms' libraries. PIC, not PIE, is for all, with that module and without:
# objects and precompiled headers have to agree. The compiler may inline as in a program: no other library replaces a function.
if(NOT THIMBLE_SANITIZE)
    target_compile_options(thimble_options INTERFACE -fPIC -fno-semantic-interposition)
endif()
# The compiler guards return addresses and buffers, and the loader makes its tables read-only: the flags of Debian's packages.
# Sanitizers see more by themselves. _FORTIFY_SOURCE needs the optimiser.
include(CheckCXXCompilerFlag)
check_cxx_compiler_flag(-fcf-protection THIMBLE_HAS_CF_PROTECTION)
if(NOT THIMBLE_SANITIZE)
    set(PROGRAM $<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>)
    target_compile_options(thimble_options INTERFACE
        "$<$<CONFIG:Release>:-fstack-protector-strong;-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=2>"
        "$<$<AND:$<CONFIG:Release>,$<BOOL:${THIMBLE_HAS_CF_PROTECTION}>>:-fcf-protection>")
    target_link_options(thimble_options INTERFACE
        "$<$<CONFIG:Release>:-Wl,-z,relro,-z,now>" "$<$<AND:$<CONFIG:Release>,${PROGRAM}>:-pie>")
endif()
if(THIMBLE_SANITIZE)
    target_compile_options(thimble_options INTERFACE -fsanitize=${THIMBLE_SANITIZE}
        -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(thimble_options INTERFACE -fsanitize=${THIMBLE_SANITIZE})
endif()

# What runs seldom, or waits most of its time, compiles in half the time without much optimisation, and under sanitizers
# in a third of it without any. Not for what runs in a tick, in a trial of virtual time, or per packet.
set(THIMBLE_SELDOM $<$<CONFIG:Release>:-Og> $<$<CONFIG:RelWithDebInfo>:-O0>)
function(thimble_seldom)
    foreach(target IN LISTS ARGN)
        target_compile_options(${target} PRIVATE ${THIMBLE_SELDOM})
        target_precompile_headers(${target} REUSE_FROM thimble_headers_seldom)
    endforeach()
endfunction()

# thimble_seldom_part(library SOURCES...): what runs seldom of a library whose other sources run in a tick. Its objects stand last, see below.
function(thimble_seldom_part library)
    set(name ${library}_seldom)
    add_library(${name} OBJECT ${ARGN})
    set_target_properties(${name} PROPERTIES ${THIMBLE_IN_UNITY})
    target_link_libraries(${name} PRIVATE $<TARGET_PROPERTY:${library},LINK_LIBRARIES>)
    thimble_seldom(${name})
    target_sources(${library} PRIVATE $<TARGET_OBJECTS:${name}>)
endfunction()

# thimble_optimised_first(program LIBRARY...): of an inline function that several objects hold, the linker keeps the first copy. In a
# program of seldom code that would be a slow one, of channels and links too: a seventh of the time of a study.
function(thimble_optimised_first program)
    list(TRANSFORM ARGN REPLACE "(.+)" "$<TARGET_FILE:\\1>")
    target_link_options(${program} PRIVATE -Wl,--whole-archive ${ARGN} -Wl,--no-whole-archive)
endfunction()

# What works by the clock of the wall waits most of its time too, which is reason enough where clang++ compiles thrice as
# long for the sanitizers. (g++ gains nothing, and the thread sanitizer's programs would be too slow for a tick.)
function(thimble_by_the_clock)
    if(THIMBLE_SANITIZE MATCHES address)
        foreach(target IN LISTS ARGN)
            target_compile_options(${target} PRIVATE -O0)
            target_precompile_headers(${target} REUSE_FROM thimble_headers_seldom)
        endforeach()
    endif()
endfunction()

# Unity builds (the sanitizers' presets, .ci/run) include sources on purpose.
set(THIMBLE_IN_UNITY UNITY_BUILD_CODE_BEFORE_INCLUDE "// NOLINTNEXTLINE(bugprone-suspicious-include)")

# The compiler parses the headers of most sources once for each set of flags. A source then takes about a tenth less time.
# clang-tidy reads every file without these headers, so that it finds a missing include. Not CLI11: a source that sees it compiles its
# constants, which takes longer than a small source.
set(THIMBLE_HEADERS <algorithm> <array> <chrono> <cmath> <deque> <filesystem> <fstream> <functional> <map> <memory> <optional>
    <set> <span> <sstream> <string> <string_view> <thread> <variant> <vector> <fmt/format.h> <fmt/ranges.h> <nlohmann/json.hpp>
    ${PROJECT_SOURCE_DIR}/cmake/format_once.hpp)
target_compile_definitions(thimble_options INTERFACE FMT_SHARED)  # as fmt's own target says: headers parsed once need it everywhere
function(thimble_headers name)  # FLAGS...
    add_library(${name} STATIC ${PROJECT_SOURCE_DIR}/cmake/headers.cpp)
    target_link_libraries(${name} PRIVATE thimble_options fmt::fmt nlohmann_json::nlohmann_json)
    target_compile_options(${name} PRIVATE ${ARGN})
    target_precompile_headers(${name} PRIVATE ${THIMBLE_HEADERS})
endfunction()

# thimble_library(name SOURCES... ) and thimble_program(name SOURCES...): a room's library and its program.
function(thimble_library name)
    cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
    add_library(${name} STATIC ${ARG_SOURCES})
    set_target_properties(${name} PROPERTIES ${THIMBLE_IN_UNITY})
    target_link_libraries(${name} PUBLIC $<BUILD_INTERFACE:thimble_options> ${ARG_LINK})
    target_precompile_headers(${name} REUSE_FROM thimble_headers)
endfunction()

# Programs are installed, except for those of bench/ and tests/.
function(thimble_program name)
    cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
    add_executable(${name} ${ARG_SOURCES})
    set_target_properties(${name} PROPERTIES ${THIMBLE_IN_UNITY})
    target_link_libraries(${name} PRIVATE thimble_options ${ARG_LINK})
    target_precompile_headers(${name} REUSE_FROM thimble_headers)
    if(NOT CMAKE_CURRENT_SOURCE_DIR MATCHES "^${PROJECT_SOURCE_DIR}/(bench|tests)")
        install(TARGETS ${name} COMPONENT programs)
    endif()
endfunction()
