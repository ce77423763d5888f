# Read by ctest. Leaks of the mock's own libraries are not ours.
foreach(test IN LISTS device_tests_TESTS unit_falcon_usb_TESTS)
    set_tests_properties(${test} PROPERTIES
        ENVIRONMENT "LD_PRELOAD=libumockdev-preload.so.0;ASAN_OPTIONS=detect_leaks=0:verify_asan_link_order=0")
endforeach()
