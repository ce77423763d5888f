# cmake -DSOURCE=FOLDER -DHEADER=FILE -P: writes the commit of the sources into a header, "-dirty" behind it if they have
# changed since. The file is touched only where its text changes, so that nothing is compiled anew without a reason.
set(COMMIT unknown)
find_package(Git QUIET)
if(GIT_FOUND AND EXISTS ${SOURCE}/.git)
    execute_process(COMMAND ${GIT_EXECUTABLE} describe --always --dirty --abbrev=12 --exclude=*
        WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE DESCRIBED RESULT_VARIABLE FAILED ERROR_QUIET
        OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(NOT FAILED)
        set(COMMIT ${DESCRIBED})
    endif()
endif()
set(TEXT "#pragma once\n\n#define THIMBLE_COMMIT \"${COMMIT}\"\n")
set(BEFORE "")
if(EXISTS ${HEADER})
    file(READ ${HEADER} BEFORE)
endif()
if(NOT BEFORE STREQUAL TEXT)
    file(WRITE ${HEADER} "${TEXT}")
endif()
