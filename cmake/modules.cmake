# One static library per module of host/ (a folder: host/GROUP/NAME, or host/NAME). Their links are the architecture;
# tests/modules checks that no module includes another that it doesn't link.
add_library(kdray_warnings INTERFACE)
target_compile_options(kdray_warnings INTERFACE -Wall -Wextra $<$<BOOL:${KDRAY_WERROR}>:-Werror>)
# g++ 12 reports std::string's own memcpy as overlapping (GCC bug 105651): off for that compiler only.
target_compile_options(kdray_warnings INTERFACE $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>)
# The host's arithmetic is as written: contraction would change the numbers between compilers, and g++ 12 at -O2 drops
# the rounding of double -> float -> double when it pairs two such conversions in a vector (seen with 12.2:
# dvec3(vec3(p)) == p), on which bounds and exact tests depend.
add_library(kdray_numerics INTERFACE)
target_compile_options(kdray_numerics INTERFACE
  -ffp-contract=off
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-fno-tree-slp-vectorize>)
add_library(kdray_sanitizers INTERFACE)
if(KDRAY_SANITIZE AND KDRAY_SANITIZE_THREADS)
  message(FATAL_ERROR "KDRAY_SANITIZE and KDRAY_SANITIZE_THREADS exclude each other: the sanitizers do")
endif()
if(KDRAY_SANITIZE_THREADS)
  target_compile_options(kdray_sanitizers INTERFACE -fsanitize=thread -fno-omit-frame-pointer)
  target_link_options(kdray_sanitizers INTERFACE -fsanitize=thread)
endif()
if(KDRAY_SANITIZE)
  # Lines are enough for reports; what is instrumented takes long enough to compile.
  target_compile_options(kdray_sanitizers INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=undefined
                                                    -fno-omit-frame-pointer -O1 -g1)
  # Instrumented code makes g++ see uninitialised uses in std::function and std::regex that are not there.
  target_compile_options(kdray_sanitizers INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(kdray_sanitizers INTERFACE -fsanitize=address,undefined)
endif()
if(KDRAY_FUZZ)
  # Quick to compile; coverage for libFuzzer; and checks that are no undefined behaviour, or that only clang has.
  target_compile_options(kdray_sanitizers INTERFACE -O1 -gline-tables-only -fsanitize=fuzzer-no-link,float-cast-overflow
                                                    -fno-sanitize-recover=float-cast-overflow)
  target_compile_definitions(kdray_sanitizers INTERFACE _GLIBCXX_ASSERTIONS)
endif()

# kdray_module(NAME SOURCES ... [PUBLIC libs...] [PRIVATE libs...] [APART])
#   Adds the library kdray_NAME (alias kdray::NAME) from the folder of that name. Headers are included as "GROUP/NAME/file.h".
#   A module's files are compiled several at a time, as one: most of the time goes into headers that all of them include. Names in
#   unnamed namespaces must differ within a module, then. (scripts/nightly compiles them one by one, so that a missing #include is found.)
#   APART: each file by itself, where the code that the compiler makes of it counts, or types in unnamed namespaces have linkage.
function(kdray_module name)
  cmake_parse_arguments(MODULE "APART" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(kdray_${name} STATIC ${MODULE_SOURCES})
  add_library(kdray::${name} ALIAS kdray_${name})
  target_compile_features(kdray_${name} PUBLIC cxx_std_20)
  set_target_properties(kdray_${name} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON EXPORT_NAME ${name})
  target_include_directories(kdray_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/host>)
  target_link_libraries(kdray_${name} PUBLIC ${MODULE_PUBLIC} PRIVATE ${MODULE_PRIVATE}
                        $<BUILD_INTERFACE:kdray_warnings> $<BUILD_INTERFACE:kdray_numerics>
                        $<BUILD_INTERFACE:kdray_sanitizers>)
  if(NOT MODULE_APART)
    set_target_properties(kdray_${name} PROPERTIES UNITY_BUILD ${KDRAY_JOIN} UNITY_BUILD_BATCH_SIZE 8)
  endif()
  set_property(GLOBAL APPEND PROPERTY KDRAY_MODULES kdray_${name})
endfunction()

# kdray_compile_quickly(TARGET HEADERS...)
#   For code that takes longer to compile than it will ever run: less optimised, and with the headers of other libraries
#   precompiled. (Not in scripts/nightly's step `includes`, so that a missing #include is found there.)
function(kdray_compile_quickly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  if(KDRAY_PRECOMPILE)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()

# kdray_papers(PROGRAM)
#   Has the program write its man pages, and kdray the shells' completions, below share in the build folder as often as it is
#   linked: they are made from its options. A program for another kind of machine can't.
function(kdray_papers program)
  if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR)
    return()
  endif()
  add_custom_command(TARGET ${program} POST_BUILD
    COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:${program}> -DSHARE=${CMAKE_BINARY_DIR}/share
            -P ${PROJECT_SOURCE_DIR}/cmake/papers.cmake
    VERBATIM)
endfunction()

# kdray_test(NAME SOURCES ... LIBS ... [LABELS ...] [APART ...])
#   One test executable per module, each of its suites a CTest test labelled as given. Its files are joined as a module's are, but for
#   those named APART, whose names others have as well.
function(kdray_test name)
  cmake_parse_arguments(T "" "" "SOURCES;LIBS;LABELS;APART" ${ARGN})
  add_executable(${name}_test ${T_SOURCES})
  set_target_properties(${name}_test PROPERTIES CXX_EXTENSIONS OFF
                        UNITY_BUILD ${KDRAY_JOIN} UNITY_BUILD_BATCH_SIZE 6)
  set_source_files_properties(${T_APART} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  target_include_directories(${name}_test PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(${name}_test PRIVATE KDRAY_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                             KDRAY_DATA_DIR="${KDRAY_DATA_DIR}")
  target_link_libraries(${name}_test PRIVATE ${T_LIBS} GTest::gtest GTest::gtest_main
                        kdray_warnings kdray_numerics kdray_sanitizers)
  target_compile_options(${name}_test PRIVATE $<$<CONFIG:Release>:-O1>)
  if(KDRAY_PRECOMPILE)
    target_precompile_headers(${name}_test REUSE_FROM kdray_test_headers)
  endif()
  set(suites ${CMAKE_CURRENT_BINARY_DIR}/${name}_suites.cmake)
  file(GENERATE OUTPUT ${suites} CONTENT
       "include(${PROJECT_SOURCE_DIR}/cmake/add_suites.cmake)\nkdray_add_suites(${name} $<TARGET_FILE:${name}_test> \"${T_LABELS}\")\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${suites})
endfunction()
