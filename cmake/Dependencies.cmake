# Everything that Kluft builds on, each with the reason that the summary of the configuration prints.
include(FeatureSummary)

function(kluft_purpose name purpose)
  set_package_properties(${name} PROPERTIES TYPE REQUIRED PURPOSE "${purpose}")
endfunction()

kluft_purpose(Eigen3 "small vectors and matrices")
find_package(Eigen3 3.4 REQUIRED NO_MODULE)

kluft_purpose(SuiteSparse "sparse factorization: CHOLMOD, UMFPACK")
find_package(SuiteSparse 5.12 REQUIRED)

kluft_purpose(BLAS "dense kernels of the factorization: OpenBLAS")
set(BLA_VENDOR OpenBLAS)
find_package(BLAS QUIET)
if(NOT BLAS_FOUND)
  message(FATAL_ERROR "OpenBLAS was not found (Debian: libopenblas-pthread-dev). The reference BLAS is 2-5 times "
                      "slower in the sparse factorization, so Kluft does not build with it.")
endif()

kluft_purpose(OpenMP "number of threads of CHOLMOD")
find_package(OpenMP REQUIRED COMPONENTS CXX)

kluft_purpose(METIS "ordering of the block graph")
find_package(METIS REQUIRED)

kluft_purpose(CGAL "exact arrangement of fractures and hexagons")
set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE TRUE)
find_package(CGAL 5.5 REQUIRED CONFIG)

kluft_purpose(Boost "Voronoi cells, the normal quantile")
find_package(Boost 1.74 REQUIRED)

kluft_purpose(yaml-cpp "scenes")
find_package(yaml-cpp REQUIRED CONFIG)

kluft_purpose(nlohmann_json "summaries and GeoJSON")
find_package(nlohmann_json REQUIRED CONFIG)

kluft_purpose(fmt "text")
find_package(fmt REQUIRED CONFIG)

kluft_purpose(spdlog "logging")
find_package(spdlog REQUIRED CONFIG)

kluft_purpose(CLI11 "command line")
find_package(CLI11 REQUIRED CONFIG)

kluft_purpose(HDF5 "saved states")
set(HDF5_PREFER_PARALLEL OFF)
find_package(HDF5 REQUIRED COMPONENTS C)

kluft_purpose(ZLIB "compressed field files")
find_package(ZLIB REQUIRED)

kluft_purpose(PkgConfig "finds Cairo")
find_package(PkgConfig REQUIRED)
pkg_check_modules(CAIRO REQUIRED IMPORTED_TARGET cairo)

# Built into the program: the pages that it writes need no other file.
find_file(KLUFT_CHART_JS chart.min.js PATHS /usr/share/javascript/chart.js PATH_SUFFIXES share/javascript/chart.js
  DOC "Chart.js 3, as one file for browsers")
if(NOT KLUFT_CHART_JS)
  message(FATAL_ERROR "Chart.js, which plots the curves of reports, was not found (Debian: libjs-chart.js)")
endif()

kluft_purpose(Threads "assembly and studies")
find_package(Threads REQUIRED)

set_package_properties(Ipopt PROPERTIES TYPE OPTIONAL
  PURPOSE "kluft calibrate, and in tests an independent method that checks the solver")
find_package(Ipopt)
option(KLUFT_BUILD_CALIBRATE "Build kluft-calibrate, which links Ipopt" ${Ipopt_FOUND})
option(KLUFT_BUILD_ORACLE "Build the tests against Ipopt (needs KLUFT_BUILD_TESTS)" ${Ipopt_FOUND})

# Loaded when a map is read that needs it: neither the start of the program nor what it links pays for it.
set_package_properties(GDAL PROPERTIES TYPE OPTIONAL
  PURPOSE "GeoPackages, shapefiles and coordinate systems of maps")
find_package(GDAL 3.4 QUIET)
option(KLUFT_GDAL "Read and write maps with GDAL" ${GDAL_FOUND})
if(KLUFT_GDAL)
  find_package(GDAL 3.4 REQUIRED)
endif()

# The Python that has NumPy (scripts/python says which), for its headers and for the tests of the package.
set(_python_by_default OFF)
if(PROJECT_IS_TOP_LEVEL AND NOT KLUFT_SANITIZE AND NOT KLUFT_COVERAGE AND NOT KLUFT_BUILD_FUZZERS) # a plain Python loads it
  if(NOT Python_EXECUTABLE)
    execute_process(COMMAND ${PROJECT_SOURCE_DIR}/scripts/python -c "import sys; print(sys.executable)"
      OUTPUT_VARIABLE _python OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(_python)
      set(Python_EXECUTABLE ${_python} CACHE FILEPATH "The interpreter that the Python package is for")
    endif()
  endif()
  find_package(Python 3.9 COMPONENTS Interpreter Development.Module QUIET)
  set(PYBIND11_FINDPYTHON ON)
  find_package(pybind11 2.10 CONFIG QUIET)
  if(Python_Interpreter_FOUND AND Python_Development.Module_FOUND AND pybind11_FOUND)
    set(_python_by_default ON)
  endif()
endif()
set_package_properties(pybind11 PROPERTIES TYPE OPTIONAL PURPOSE "the Python package")
option(KLUFT_PYTHON "Build the Python package" ${_python_by_default})

add_feature_info(calibrate KLUFT_BUILD_CALIBRATE "kluft calibrate, a program of its own with Ipopt")
add_feature_info(oracle KLUFT_BUILD_ORACLE "the solver against Ipopt, label oracle of ctest")
add_feature_info(gdal KLUFT_GDAL "maps as GeoPackage and shapefile, coordinate systems")
add_feature_info(python KLUFT_PYTHON "the package kluft in <build>/python")
add_feature_info(tests KLUFT_BUILD_TESTS "GoogleTest, run by ctest")
add_feature_info(benchmarks KLUFT_BUILD_BENCH "Google Benchmark, run by scripts/bench")
add_feature_info(sanitizers KLUFT_SANITIZE "address and undefined behaviour")
add_feature_info(coverage KLUFT_COVERAGE "gcov counters")
