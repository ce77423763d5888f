# Read by ctest. Whole runs, on one machine or several, are compared with virtual time: they get the machine to themselves.
foreach(test IN LISTS loopback_tests_TESTS)
    if(test MATCHES "^(WholeRun|Lab[.]Four)")
        set_tests_properties(${test} PROPERTIES RUN_SERIAL ON)
    endif()
endforeach()
