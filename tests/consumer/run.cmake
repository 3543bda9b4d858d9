# Run by the CTest of test.cmake with BUILD, SOURCE, SCENE, WORK, GENERATOR, BOX, EXAMPLES, BENCH (is kdray-bench to be there), CC, CONFIG and CXX; stops at the first failure.
file(REMOVE_RECURSE ${WORK})

function(step)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

step(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix --config ${CONFIG})
foreach(file bin/kdray include/kdray/kdray.h include/kdray/error.h share/kdray/kernels/layout/features.h
        share/man/man1/kdray.1 share/man/man1/kdray-render.1 share/bash-completion/completions/kdray
        share/zsh/site-functions/_kdray share/fish/vendor_completions.d/kdray.fish)
  if(NOT EXISTS ${WORK}/prefix/${file})
    message(FATAL_ERROR "not installed: ${file}")
  endif()
endforeach()
# Moved, to see that the package holds no absolute paths of its prefix.
file(RENAME ${WORK}/prefix ${WORK}/moved)
step(${CMAKE_COMMAND} -DEXAMPLES=${EXAMPLES} -S ${SOURCE} -B ${WORK}/build -G ${GENERATOR} -DCMAKE_BUILD_TYPE=${CONFIG}
     -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_PREFIX_PATH=${WORK}/moved)
step(${CMAKE_COMMAND} --build ${WORK}/build)
step(${WORK}/build/consumer ${SCENE})
step(${WORK}/build/c_interface ${BOX})
step(${WORK}/build/lidar ${WORK}/points.ply)
step(${WORK}/build/picture ${WORK}/picture.ppm)
execute_process(COMMAND ${WORK}/build/inside ${BOX} 0.5 0.25 0.125 OUTPUT_VARIABLE told COMMAND_ERROR_IS_FATAL ANY)
if(NOT told MATCHES "^inside, 0.125 from \\(0.5, 0.25, 0\\)|no OpenCL device")
  message(FATAL_ERROR "the point in the box: ${told}")
endif()
# The library tells nothing of C++: its symbols are those of the list.
file(GLOB library ${WORK}/moved/lib*/libkdray.so ${WORK}/moved/lib/*/libkdray.so)
execute_process(COMMAND nm -D --defined-only ${library} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[TDBRVW] [^\n]+" symbols "${symbols}")
list(TRANSFORM symbols REPLACE "^. ([^@]+).*$" "\\1")
list(FILTER symbols EXCLUDE REGEX "^KDRAY_")
list(SORT symbols)
file(STRINGS ${SOURCE}/symbols.txt expected)
if(NOT symbols STREQUAL expected)
  message(FATAL_ERROR "libkdray.so has other symbols than symbols.txt:\n${symbols}")
endif()
# By pkg-config as well.
find_program(pkg_config pkg-config)
if(pkg_config)
  file(GLOB_RECURSE pc ${WORK}/moved/*/kdray.pc)
  cmake_path(GET pc PARENT_PATH folder)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${folder} ${pkg_config} --cflags --libs kdray
                  OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  step(${CC} -std=c99 -pedantic -Werror ${SOURCE}/c_interface.c -o ${WORK}/by_pkg_config ${flags} -lm)
endif()
# The installed program finds all it needs, without the source tree.
step(${CMAKE_COMMAND} -E chdir ${WORK} ${WORK}/moved/bin/kdray --version)
if(BENCH)
  step(${CMAKE_COMMAND} -E chdir ${WORK} ${WORK}/moved/bin/kdray bench --help)
  if(NOT EXISTS ${WORK}/moved/bin/kdray-bench-plot)
    message(FATAL_ERROR "not installed: bin/kdray-bench-plot")
  endif()
endif()
