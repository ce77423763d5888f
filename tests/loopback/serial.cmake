# Read by ctest. A whole run by the wall clock is compared with virtual time, and beside busy real-time loops the
# emulated drives wait for seconds: three places, which leave deploy/test one for something small beside them. They begin first,
# while there is enough that is small.
foreach(test IN LISTS loopback_tests_TESTS)
    if(test MATCHES "^(WholeRun|DriveRun[.]A[TF])")
        set_tests_properties(${test} PROPERTIES PROCESSORS 3 COST 1000)
    endif()
endforeach()
