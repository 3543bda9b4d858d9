# The CTest consumer/installed_package: installs the build below a folder of its own, then configures, builds and runs
# the project beside this file against it. Sanitized libraries would force their sanitizers on the consumer.
if(TARGET kdray_c AND NOT KDRAY_SANITIZE AND NOT KDRAY_SANITIZE_THREADS)
  add_test(NAME consumer/installed_package
           COMMAND ${CMAKE_COMMAND}
                   -DBUILD=${PROJECT_BINARY_DIR}
                   -DSOURCE=${CMAKE_CURRENT_LIST_DIR}
                   -DSCENE=${PROJECT_SOURCE_DIR}/scenes/balls.nff
                   -DWORK=${PROJECT_BINARY_DIR}/consumer
                   -DBENCH=$<TARGET_EXISTS:kdray_bench_program>
                   -DGENERATOR=${CMAKE_GENERATOR}
                   -DCONFIG=$<CONFIG>
                   -DCXX=${CMAKE_CXX_COMPILER}
                   -DCC=${CMAKE_C_COMPILER}
                   -DEXAMPLES=${PROJECT_SOURCE_DIR}/examples
                   -DBOX=${CMAKE_CURRENT_LIST_DIR}/box.obj
                   -P ${CMAKE_CURRENT_LIST_DIR}/run.cmake)
  # No device, no picture: the program says so.
  set_tests_properties(consumer/installed_package PROPERTIES LABELS "slow;device"
                       SKIP_REGULAR_EXPRESSION "no OpenCL device: skipped")
endif()
