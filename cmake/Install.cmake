# What `cmake --install` puts on a machine, and the Debian packages that cpack makes of it: a package for each component.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(KLUFT_SHARE ${CMAKE_INSTALL_DATADIR}/kluft)
set(KLUFT_CONFIG_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/kluft)

# ---- program: kluft, its manual, its models and what `kluft validate` needs
install(TARGETS kluft_cli RUNTIME COMPONENT program)
install(PROGRAMS scripts/validate scripts/python DESTINATION ${KLUFT_SHARE}/scripts COMPONENT program)
install(DIRECTORY validation DESTINATION ${KLUFT_SHARE} USE_SOURCE_PERMISSIONS COMPONENT program
  PATTERN triaxial EXCLUDE PATTERN __pycache__ EXCLUDE PATTERN "report.md" EXCLUDE PATTERN "report.html" EXCLUDE)
# The frame of its report.
install(FILES src/report/page/frame.html src/report/page/frame.css src/report/page/frame.js
  DESTINATION ${KLUFT_SHARE}/src/report/page COMPONENT program)
install(DIRECTORY models DESTINATION ${KLUFT_SHARE} COMPONENT program)
# The readers of the package, which need NumPy only.
install(DIRECTORY python/kluft DESTINATION ${KLUFT_SHARE}/python COMPONENT program FILES_MATCHING PATTERN "*.py")
install(DIRECTORY docs/schema DESTINATION ${KLUFT_SHARE}/docs COMPONENT program)

# The program says its manual and the scripts of the shells itself.
find_program(GZIP_PROGRAM gzip)
mark_as_advanced(GZIP_PROGRAM)
if(PROJECT_IS_TOP_LEVEL AND GZIP_PROGRAM AND NOT KLUFT_SANITIZE AND NOT KLUFT_COVERAGE AND NOT KLUFT_BUILD_FUZZERS)
  set(_said ${PROJECT_BINARY_DIR}/said)
  add_custom_command(OUTPUT ${_said}/stamp VERBATIM COMMENT ""
    COMMAND ${CMAKE_COMMAND} -D PROGRAM=$<TARGET_FILE:kluft_cli> -D DIRECTORY=${_said} -D GZIP=${GZIP_PROGRAM}
            -P ${PROJECT_SOURCE_DIR}/cmake/WriteManual.cmake
    DEPENDS kluft_cli ${PROJECT_SOURCE_DIR}/cmake/WriteManual.cmake)
  add_custom_target(kluft_manual ALL DEPENDS ${_said}/stamp)
  install(DIRECTORY ${_said}/man1 ${_said}/man5 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program)
  install(FILES ${_said}/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME kluft
    COMPONENT program)
  install(FILES ${_said}/completion.zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions RENAME _kluft
    COMPONENT program)
  install(FILES ${_said}/completion.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d RENAME kluft.fish
    COMPONENT program)
endif()

# ---- calibrate: for who builds Kluft; packages leave it out (docs/licences.md)
if(KLUFT_BUILD_CALIBRATE)
  install(TARGETS kluft_calibrate RUNTIME COMPONENT calibrate)
endif()

# ---- development: the library and what find_package(kluft) needs
install(TARGETS kluft EXPORT kluftTargets COMPONENT development)
install(DIRECTORY include/kluft TYPE INCLUDE COMPONENT development FILES_MATCHING PATTERN "*.hpp")
install(EXPORT kluftTargets NAMESPACE kluft:: DESTINATION ${KLUFT_CONFIG_DIR} COMPONENT development)
configure_package_config_file(cmake/kluftConfig.cmake.in ${PROJECT_BINARY_DIR}/kluftConfig.cmake
  INSTALL_DESTINATION ${KLUFT_CONFIG_DIR} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kluftConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kluftConfig.cmake ${PROJECT_BINARY_DIR}/kluftConfigVersion.cmake
  cmake/FindSuiteSparse.cmake cmake/FindMETIS.cmake DESTINATION ${KLUFT_CONFIG_DIR} COMPONENT development)

# ---- python: python/CMakeLists.txt

# ---- documents: the pages as they are written, and as scripts/docs has made a site of them
set(KLUFT_DOCUMENTS ${CMAKE_INSTALL_DATADIR}/doc/kluft-doc)
install(FILES README.md DESTINATION ${KLUFT_DOCUMENTS} COMPONENT documents)
install(DIRECTORY docs DESTINATION ${KLUFT_DOCUMENTS} COMPONENT documents
  PATTERN schema EXCLUDE PATTERN site EXCLUDE PATTERN __pycache__ EXCLUDE)
install(DIRECTORY ${PROJECT_BINARY_DIR}/site/ DESTINATION ${KLUFT_DOCUMENTS}/html COMPONENT documents OPTIONAL)

# ---- Debian packages
# What Debian wants of every package: whose it is, and what has changed.
configure_file(cmake/copyright.in ${PROJECT_BINARY_DIR}/debian/copyright @ONLY)
configure_file(cmake/changelog.in ${PROJECT_BINARY_DIR}/debian/changelog @ONLY)
if(GZIP_PROGRAM)
  execute_process(COMMAND ${GZIP_PROGRAM} -9nfk ${PROJECT_BINARY_DIR}/debian/changelog)
  foreach(_pair program:kluft development:libkluft-dev python:python3-kluft documents:kluft-doc)
    string(REPLACE ":" ";" _pair ${_pair})
    list(GET _pair 0 _component)
    list(GET _pair 1 _package)
    install(FILES ${PROJECT_BINARY_DIR}/debian/copyright ${PROJECT_BINARY_DIR}/debian/changelog.gz
      DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${_package} COMPONENT ${_component})
  endforeach()
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "Kluft developers <kluft@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "strength of fractured rock by distinct elements")
set(CPACK_COMPONENTS_ALL program development documents)
if(KLUFT_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME kluft)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "Cuts a body of rock into blocks along fractures and potential cracks, loads it
step by step to equilibrium, and lets potential cracks break. With its manual,
its models and its validation suite.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# The shared library that BLAS resolves to is chosen at run time; without this the slow reference BLAS would satisfy it.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS libopenblas0-pthread)
# The suite behind `kluft validate`, and the font of the pictures.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "python3, python3-numpy, python3-yaml, python3-matplotlib, python3-scipy, fonts-dejavu-core")
# Loaded where a map needs it, so that no link tells of it.
if(KLUFT_GDAL)
  string(REGEX REPLACE "^libgdal\\.so\\.([0-9]+)$" "libgdal\\1" _gdal_package ${KLUFT_GDAL_NAME})
  string(APPEND CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS ", ${_gdal_package}")
endif()
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libkluft-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "What programs need that compute with Kluft: find_package(kluft) of CMake finds
the static library and its headers.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libeigen3-dev, libsuitesparse-dev, libopenblas-pthread-dev, libmetis-dev, \
libcgal-dev, libboost-dev, libyaml-cpp-dev, libfmt-dev, libspdlog-dev, libhdf5-dev, libcairo2-dev, zlib1g-dev, pkgconf")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-kluft)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "Reads results of Kluft as NumPy arrays, makes and runs scenes, and takes a run
step by step.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
math(EXPR _next_python "${Python_VERSION_MINOR} + 1")
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${_next_python}), python3-numpy, \
libopenblas0-pthread, kluft (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-matplotlib")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-pandas, python3-geopandas, python3-vtk9")
set(CPACK_DEBIAN_DOCUMENTS_PACKAGE_NAME kluft-doc)
set(CPACK_DEBIAN_DOCUMENTS_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOCUMENTS_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOCUMENTS_DESCRIPTION "Tutorials, the reference of scenes, theory, accuracy and validation of Kluft.")
include(CPack)
