# Read by ctest after the tests have been discovered.
if(elements_verification_test_TESTS)
  set_tests_properties(${elements_verification_test_TESTS} PROPERTIES LABELS verification)
endif()
