# Read by ctest after the tests have been discovered.
if(mpm_verification_test_TESTS)
  set_tests_properties(${mpm_verification_test_TESTS} PROPERTIES LABELS verification)
endif()
