# SPDX-License-Identifier: Apache-2.0

# MuJoCo's C library: target MuJoCo::mujoco. Of the ROS package mujoco_vendor, of an installation, or of the Python
# package `mujoco`. Where none is found by itself: -DMuJoCo_ROOT=<directory with include/mujoco/mujoco.h>.
#
# MuJoCo_wheel: the library is a wheel's, to be installed beside what needs it.

find_package(mujoco_vendor QUIET)
if(TARGET mujoco::mujoco)
  set(MuJoCo_FOUND TRUE)
  if(NOT TARGET MuJoCo::mujoco)
    add_library(MuJoCo::mujoco INTERFACE IMPORTED)
    set_target_properties(MuJoCo::mujoco PROPERTIES INTERFACE_LINK_LIBRARIES mujoco::mujoco)
  endif()
  return()
endif()

if(Python3_EXECUTABLE)
  set(MuJoCo_python ${Python3_EXECUTABLE})
else()
  find_program(MuJoCo_python NAMES python3)
endif()
if(MuJoCo_python AND NOT MuJoCo_package)
  execute_process(
    COMMAND ${MuJoCo_python} -c
      "import importlib.util as u; print(u.find_spec('mujoco').submodule_search_locations[0])"
    OUTPUT_VARIABLE MuJoCo_package OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()

find_path(MuJoCo_INCLUDE_DIR mujoco/mujoco.h HINTS "${MuJoCo_package}/include")
# A wheel's library has its version in its name only.
file(GLOB MuJoCo_versioned "${MuJoCo_package}/libmujoco.so.*" "${MuJoCo_ROOT}/libmujoco.so.*")
find_library(MuJoCo_LIBRARY NAMES mujoco HINTS "${MuJoCo_package}")
if(NOT MuJoCo_LIBRARY AND MuJoCo_versioned)
  list(GET MuJoCo_versioned 0 MuJoCo_LIBRARY)
  set(MuJoCo_wheel ON)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(MuJoCo REQUIRED_VARS MuJoCo_LIBRARY MuJoCo_INCLUDE_DIR
  REASON_FAILURE_MESSAGE "install ros-DISTRO-mujoco-vendor with apt or mujoco with pip, or set MuJoCo_ROOT")
if(MuJoCo_FOUND AND NOT TARGET MuJoCo::mujoco)
  add_library(MuJoCo::mujoco UNKNOWN IMPORTED)
  set_target_properties(MuJoCo::mujoco PROPERTIES
    IMPORTED_LOCATION "${MuJoCo_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${MuJoCo_INCLUDE_DIR}")
endif()
