# One interface library carries every flag, so that no target can forget one.
add_library(thimble_options INTERFACE)
target_include_directories(thimble_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_definitions(thimble_options INTERFACE THIMBLE_VERSION="${PROJECT_VERSION}")
# -ffp-contract=off: the same bits from every compiler and build type, which seeds and golden files rely on.
target_compile_options(thimble_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
    -Wno-sign-conversion -Wdouble-promotion -Wnon-virtual-dtor -Werror -ffp-contract=off)
if(THIMBLE_SANITIZE)
    target_compile_options(thimble_options INTERFACE -fsanitize=${THIMBLE_SANITIZE}
        -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(thimble_options INTERFACE -fsanitize=${THIMBLE_SANITIZE})
endif()

# thimble_library(name SOURCES... ) and thimble_program(name SOURCES...): a room's library and its program.
function(thimble_library name)
    cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
    add_library(${name} STATIC ${ARG_SOURCES})
    target_link_libraries(${name} PUBLIC thimble_options ${ARG_LINK})
endfunction()

function(thimble_program name)
    cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
    add_executable(${name} ${ARG_SOURCES})
    target_link_libraries(${name} PRIVATE thimble_options ${ARG_LINK})
endfunction()
