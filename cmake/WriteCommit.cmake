# cmake -D SOURCE_DIR=... -D FILE=... -P WriteCommit.cmake: a header with the commit that is built, "" outside of a checkout of git.
# The file is touched only where that has changed.
execute_process(COMMAND git -C ${SOURCE_DIR} describe --always --dirty --exclude=* OUTPUT_VARIABLE commit
  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  set(commit "")
endif()
file(CONFIGURE OUTPUT ${FILE} CONTENT "#define KLUFT_COMMIT \"${commit}\"\n")
