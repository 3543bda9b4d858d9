# What    Adds a CTest test for each suite of a test program: read by ctest, when it knows which tests there are.
# Why     A suite's cases share a process: its OpenCL device is opened and its kernels are compiled once, which takes longer
#         than most cases.
# Shape   kdray_add_suites(NAME PROGRAM LABELS): tests NAME/SUITE. A case alone: PROGRAM --gtest_filter=SUITE.CASE.
#         Suites that take over half a minute come first, so that none of them is left to the end by itself: ctest knows what
#         took how long from its second run on.
set(kdray_long_suites "(FeaturesTest|MpirunTest|OddFiles|BenchAblation|TraversalTest|Modes|AnyWalk|WarmUp|Leaks|DriversThatFail|Adaptive)$")
function(kdray_add_suites name program labels)
  execute_process(COMMAND ${program} --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    add_test("${name}/NOT_BUILT" ${program} --gtest_list_tests)  # fails, and says why
    return()
  endif()
  string(REGEX MATCHALL "[^\n]+" lines "${listed}")
  foreach(line IN LISTS lines)
    if(line MATCHES "^([^ ]+)\\.( +#.*)?$")
      set(suite "${CMAKE_MATCH_1}")
      add_test("${name}/${suite}" ${program} "--gtest_filter=${suite}.*")
      set_tests_properties("${name}/${suite}" PROPERTIES LABELS "${labels}" TIMEOUT 7200)
      if(suite MATCHES "${kdray_long_suites}")
        set_tests_properties("${name}/${suite}" PROPERTIES COST 60)
      endif()
    endif()
  endforeach()
endfunction()
