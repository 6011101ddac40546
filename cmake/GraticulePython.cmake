# Whether the Python module is built, for which interpreter, and where it is installed.
if(NOT GRATICULE_BUILD_PYTHON)
  return()
endif()
if(GRATICULE_SANITIZE)
  # A plain python cannot load it: the sanitizers' runtime must come first in a process.
  message(STATUS "No Python module: it cannot be loaded where GRATICULE_SANITIZE is set")
  return()
endif()
# Debian's interpreter, which Debian's numpy is for, unless another one is named.
if(NOT Python_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "The interpreter that the Python module is for")
endif()
find_package(Python 3.9 QUIET COMPONENTS Interpreter Development.Module)
set(PYBIND11_FINDPYTHON ON)
if(Python_FOUND)
  find_package(pybind11 2.10 QUIET)
endif()
if(Python_FOUND)
  execute_process(COMMAND "${Python_EXECUTABLE}" -c "import numpy" RESULT_VARIABLE without_numpy ERROR_QUIET)
endif()
if(NOT Python_FOUND OR NOT pybind11_FOUND OR without_numpy)
  message(STATUS "No Python module: install python3-dev, python3-numpy and pybind11-dev")
  return()
endif()
# Debian's packages install where every version of Python 3 looks; others where their own does.
execute_process(
  COMMAND "${Python_EXECUTABLE}" -c
    "import sys, sysconfig; print('dist-packages' if 'deb_system' in sysconfig.get_scheme_names() else sysconfig.get_path('purelib', vars={'base': ''}))"
  OUTPUT_VARIABLE site OUTPUT_STRIP_TRAILING_WHITESPACE)
if(site STREQUAL "dist-packages")
  set(site "lib/python3/dist-packages")
endif()
string(REGEX REPLACE "^/" "" site "${site}")
set(GRATICULE_PYTHON_INSTALL_DIR "${site}" CACHE STRING "Where the Python module is installed, under the prefix")
add_subdirectory("${PROJECT_SOURCE_DIR}/python" "${PROJECT_BINARY_DIR}/python")
