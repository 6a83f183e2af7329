# Debian's Ipopt 3.11 has no CMake files of its own. Defines Ipopt::Ipopt.
find_path(Ipopt_INCLUDE_DIR IpTNLP.hpp PATH_SUFFIXES coin coin-or)
find_library(Ipopt_LIBRARY ipopt)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Ipopt REQUIRED_VARS Ipopt_LIBRARY Ipopt_INCLUDE_DIR)
mark_as_advanced(Ipopt_LIBRARY Ipopt_INCLUDE_DIR)
if(Ipopt_FOUND AND NOT TARGET Ipopt::Ipopt)
  add_library(Ipopt::Ipopt UNKNOWN IMPORTED)
  # Without HAVE_CSTDDEF the headers of 2013 stop with "don't have header file for stddef".
  set_target_properties(Ipopt::Ipopt PROPERTIES
    IMPORTED_LOCATION ${Ipopt_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${Ipopt_INCLUDE_DIR}
    INTERFACE_COMPILE_DEFINITIONS HAVE_CSTDDEF)
endif()
