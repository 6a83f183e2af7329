# cmake -D BUILD_DIR=... -D WORK_DIR=... -D GENERATOR=... -D VERSION=... -P build_and_run.cmake
function(run)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${WORK_DIR}/build -G ${GENERATOR}
    -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
run(${WORK_DIR}/build/consumer)
if(NOT output STREQUAL "${VERSION} 1e+10\n")
  message(FATAL_ERROR "expected the version and the rock's modulus, got: ${output}")
endif()
run(${WORK_DIR}/prefix/bin/kluft --help)
# The suite of the installed program, into a directory of its own.
execute_process(COMMAND ${WORK_DIR}/prefix/bin/kluft validate incline -o ${WORK_DIR}/validation
  OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "the installed program cannot validate: ${output}")
endif()
