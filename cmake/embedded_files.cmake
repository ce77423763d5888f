# thimble_embed(VARIABLE FILES...): sets VARIABLE to the C++ initialisers {"NAME", R"embedded(TEXT)embedded"}, of
# the files, so that a program finds what comes with it wherever it is started. A change of a file configures anew.
function(thimble_embed VARIABLE)
    set(TEXTS "")
    foreach(FILE ${ARGN})
        file(READ ${FILE} TEXT)
        get_filename_component(NAME ${FILE} NAME)
        string(APPEND TEXTS "\n        {\"${NAME}\", R\"embedded(${TEXT})embedded\"},")
        set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${FILE})
    endforeach()
    set(${VARIABLE} "${TEXTS}" PARENT_SCOPE)
endfunction()
