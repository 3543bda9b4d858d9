# Run by the CTest of test.cmake with BUILD, SOURCE, SCENE, WORK, GENERATOR, BENCH (is kdray-bench to be there), CONFIG and CXX; stops at the first failure.
file(REMOVE_RECURSE ${WORK})

function(step)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

step(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix --config ${CONFIG})
foreach(file bin/kdray include/kdray/kdray.h include/kdray/error.h share/kdray/kernels/layout/features.h)
  if(NOT EXISTS ${WORK}/prefix/${file})
    message(FATAL_ERROR "not installed: ${file}")
  endif()
endforeach()
# Moved, to see that the package holds no absolute paths of its prefix.
file(RENAME ${WORK}/prefix ${WORK}/moved)
step(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -G ${GENERATOR} -DCMAKE_BUILD_TYPE=${CONFIG}
     -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_PREFIX_PATH=${WORK}/moved)
step(${CMAKE_COMMAND} --build ${WORK}/build)
step(${WORK}/build/consumer ${SCENE})
# The installed program finds all it needs, without the source tree.
step(${CMAKE_COMMAND} -E chdir ${WORK} ${WORK}/moved/bin/kdray --version)
if(BENCH)
  step(${CMAKE_COMMAND} -E chdir ${WORK} ${WORK}/moved/bin/kdray bench --help)
endif()
