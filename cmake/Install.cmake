# What `cmake --install` and `cpack` put on a machine: the program, the library and what find_package(kluft) needs.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(KLUFT_CONFIG_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/kluft)
install(TARGETS kluft_cli RUNTIME)
install(TARGETS kluft EXPORT kluftTargets)
# For who builds Kluft; packages leave it out (docs/licences.md).
if(KLUFT_BUILD_CALIBRATE)
  install(TARGETS kluft_calibrate RUNTIME COMPONENT calibrate)
endif()
install(DIRECTORY include/kluft TYPE INCLUDE FILES_MATCHING PATTERN "*.hpp")
install(EXPORT kluftTargets NAMESPACE kluft:: DESTINATION ${KLUFT_CONFIG_DIR})
configure_package_config_file(cmake/kluftConfig.cmake.in ${PROJECT_BINARY_DIR}/kluftConfig.cmake
  INSTALL_DESTINATION ${KLUFT_CONFIG_DIR} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kluftConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kluftConfig.cmake ${PROJECT_BINARY_DIR}/kluftConfigVersion.cmake
  cmake/FindSuiteSparse.cmake cmake/FindMETIS.cmake DESTINATION ${KLUFT_CONFIG_DIR})
install(FILES scripts/completions/kluft.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME kluft)
install(PROGRAMS scripts/validate scripts/python DESTINATION ${CMAKE_INSTALL_DATADIR}/kluft/scripts)
install(DIRECTORY validation DESTINATION ${CMAKE_INSTALL_DATADIR}/kluft
  PATTERN triaxial EXCLUDE PATTERN __pycache__ EXCLUDE PATTERN "report.md" EXCLUDE PATTERN "report.html" EXCLUDE)
# The frame of its report.
install(FILES src/report/page/frame.html src/report/page/frame.css src/report/page/frame.js
  DESTINATION ${CMAKE_INSTALL_DATADIR}/kluft/src/report/page)
# The readers of the package, which need NumPy only.
install(DIRECTORY python/kluft DESTINATION ${CMAKE_INSTALL_DATADIR}/kluft/python FILES_MATCHING PATTERN "*.py")
install(DIRECTORY docs/schema DESTINATION ${CMAKE_INSTALL_DATADIR}/kluft)
install(FILES README.md LICENSE docs/licences.md TYPE DOC)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "Kluft developers")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# The shared library that BLAS resolves to is chosen at run time; without this the slow reference BLAS would satisfy it.
set(CPACK_DEBIAN_PACKAGE_DEPENDS libopenblas0-pthread)
# The suite behind `kluft validate`.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3, python3-numpy, python3-matplotlib")
set(CPACK_STRIP_FILES ON)
# Without the component calibrate, whose licences do not allow it to be handed on.
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};${PROJECT_NAME};Unspecified;/")
include(CPack)
