# Read by ctest. Whole runs, and those in namespaces, are compared with virtual time: they get the machine to themselves.
foreach(test IN LISTS loopback_tests_TESTS)
    if(test MATCHES "^(WholeRun|Lab)[.]")
        set_tests_properties(${test} PROPERTIES RUN_SERIAL ON)
    endif()
endforeach()
