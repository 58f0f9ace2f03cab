# SPDX-License-Identifier: Apache-2.0
#
# CasADi of an installation or of the Python package `casadi`: target CasADi::casadi. It generates C
# when the benchmarks are built, and isn't needed when they run.

find_package(Python3 QUIET COMPONENTS Interpreter)
if(Python3_Interpreter_FOUND AND NOT CasADi_package)
  execute_process(
    COMMAND ${Python3_EXECUTABLE} -c
      "import importlib.util as u; print(u.find_spec('casadi').submodule_search_locations[0])"
    OUTPUT_VARIABLE CasADi_package OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()

if(CasADi_INCLUDE_DIR AND NOT EXISTS "${CasADi_INCLUDE_DIR}/casadi/casadi.hpp") # uninstalled since
  unset(CasADi_INCLUDE_DIR CACHE)
  unset(CasADi_LIBRARY CACHE)
endif()
find_path(CasADi_INCLUDE_DIR casadi/casadi.hpp HINTS "${CasADi_package}/include")
# A wheel's library may have its version in its name only.
file(GLOB CasADi_versioned "${CasADi_package}/libcasadi.so*")
find_library(CasADi_LIBRARY NAMES casadi HINTS "${CasADi_package}")
if(NOT CasADi_LIBRARY AND CasADi_versioned)
  list(GET CasADi_versioned 0 CasADi_LIBRARY)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(CasADi REQUIRED_VARS CasADi_LIBRARY CasADi_INCLUDE_DIR)
mark_as_advanced(CasADi_INCLUDE_DIR CasADi_LIBRARY)
if(CasADi_FOUND AND NOT TARGET CasADi::casadi)
  file(STRINGS "${CasADi_INCLUDE_DIR}/casadi/config.h" CasADi_line
    REGEX "CASADI_VERSION_STRING")
  string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" CasADi_VERSION "${CasADi_line}")
  add_library(CasADi::casadi UNKNOWN IMPORTED)
  set_target_properties(CasADi::casadi PROPERTIES
    IMPORTED_LOCATION "${CasADi_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${CasADi_INCLUDE_DIR}")
endif()
