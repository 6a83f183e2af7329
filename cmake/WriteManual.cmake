# cmake -D PROGRAM=... -D DIRECTORY=... -D GZIP=... -P WriteManual.cmake
# The pages of the manual and the scripts of the shells, as the program says them.
file(REMOVE_RECURSE ${DIRECTORY})
execute_process(COMMAND ${PROGRAM} manual ${DIRECTORY}/pages COMMAND_ERROR_IS_FATAL ANY)
foreach(section 1 5)
  file(GLOB pages ${DIRECTORY}/pages/*.${section})
  file(COPY ${pages} DESTINATION ${DIRECTORY}/man${section})
  file(GLOB pages ${DIRECTORY}/man${section}/*)
  execute_process(COMMAND ${GZIP} -9nf ${pages} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
foreach(shell bash zsh fish)
  execute_process(COMMAND ${PROGRAM} completion ${shell} OUTPUT_FILE ${DIRECTORY}/completion.${shell}
    COMMAND_ERROR_IS_FATAL ANY)
endforeach()
file(TOUCH ${DIRECTORY}/stamp)
