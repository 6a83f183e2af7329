# One test of CTest for each suite of a GoogleTest program: a program that takes as long to start as most of its tests to
# run is not started for each of them. `kluft_discover_suites(target [PROPERTIES ...])` lists the suites after each build;
# run as a script with PROGRAM, FILE and PROPERTIES it writes that list.
if(CMAKE_SCRIPT_MODE_FILE)
  execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE list COMMAND_ERROR_IS_FATAL ANY TIMEOUT 60)
  string(REGEX MATCHALL "[^\n]+" lines "${list}")
  set(tests "")
  foreach(line IN LISTS lines)
    if(line MATCHES "^([A-Za-z0-9_/]+)\\.( |$)")
      set(suite ${CMAKE_MATCH_1})
      string(APPEND tests "add_test([[${suite}]] [[${PROGRAM}]] [[--gtest_filter=${suite}.*]] --gtest_brief=1)\n"
        "set_tests_properties([[${suite}]] PROPERTIES ${PROPERTIES})\n")
    endif()
  endforeach()
  file(WRITE ${FILE} "${tests}")
  return()
endif()

function(kluft_discover_suites target)
  cmake_parse_arguments(PARSE_ARGV 1 suites "" "" "PROPERTIES")
  set(properties "")
  foreach(property IN LISTS suites_PROPERTIES)
    string(APPEND properties " [[${property}]]")
  endforeach()
  set(file ${CMAKE_CURRENT_BINARY_DIR}/${target}_suites.cmake)
  add_custom_command(TARGET ${target} POST_BUILD VERBATIM BYPRODUCTS ${file} COMMENT ""
    COMMAND ${CMAKE_COMMAND} -D "PROGRAM=$<TARGET_FILE:${target}>" -D "FILE=${file}" -D "PROPERTIES=${properties}"
            -P ${CMAKE_CURRENT_FUNCTION_LIST_FILE})
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${file})
endfunction()
