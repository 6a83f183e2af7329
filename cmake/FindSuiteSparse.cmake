# SuiteSparse::CHOLMOD and SuiteSparse::UMFPACK of a SuiteSparse without its own CMake package (before 7).
find_path(SuiteSparse_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
find_library(SuiteSparse_CHOLMOD_LIBRARY cholmod)
find_library(SuiteSparse_UMFPACK_LIBRARY umfpack)
find_library(SuiteSparse_config_LIBRARY suitesparseconfig)
if(SuiteSparse_INCLUDE_DIR AND EXISTS ${SuiteSparse_INCLUDE_DIR}/SuiteSparse_config.h)
  file(STRINGS ${SuiteSparse_INCLUDE_DIR}/SuiteSparse_config.h _lines REGEX "define SUITESPARSE_(MAIN|SUB|SUBSUB)_VERSION")
  foreach(_part MAIN SUB SUBSUB)
    string(REGEX MATCH "SUITESPARSE_${_part}_VERSION +([0-9]+)" _match "${_lines}")
    list(APPEND _version ${CMAKE_MATCH_1})
  endforeach()
  list(JOIN _version "." SuiteSparse_VERSION)
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SuiteSparse
  REQUIRED_VARS SuiteSparse_CHOLMOD_LIBRARY SuiteSparse_UMFPACK_LIBRARY SuiteSparse_config_LIBRARY SuiteSparse_INCLUDE_DIR
  VERSION_VAR SuiteSparse_VERSION)
if(SuiteSparse_FOUND)
  foreach(_name CHOLMOD UMFPACK)
    if(NOT TARGET SuiteSparse::${_name})
      add_library(SuiteSparse::${_name} UNKNOWN IMPORTED)
      set_target_properties(SuiteSparse::${_name} PROPERTIES
        IMPORTED_LOCATION ${SuiteSparse_${_name}_LIBRARY}
        INTERFACE_INCLUDE_DIRECTORIES ${SuiteSparse_INCLUDE_DIR}
        INTERFACE_LINK_LIBRARIES ${SuiteSparse_config_LIBRARY})
    endif()
  endforeach()
endif()
mark_as_advanced(SuiteSparse_INCLUDE_DIR SuiteSparse_CHOLMOD_LIBRARY SuiteSparse_UMFPACK_LIBRARY SuiteSparse_config_LIBRARY)
