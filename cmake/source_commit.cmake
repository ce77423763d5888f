# cmake -DSOURCE=FOLDER -DOUTPUT=FILE -P: writes the commit of the sources as source_commit() (thimble/commands/shared.hpp), "-dirty"
# behind it if they have changed since. The file is touched only where its text changes: nothing is compiled anew without a reason.
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
set(TEXT "#include \"thimble/commands/shared.hpp\"\n\nconst char* thimble::source_commit() { return \"${COMMIT}\"; }\n")
set(BEFORE "")
if(EXISTS ${OUTPUT})
    file(READ ${OUTPUT} BEFORE)
endif()
if(NOT BEFORE STREQUAL TEXT)
    file(WRITE ${OUTPUT} "${TEXT}")
endif()
