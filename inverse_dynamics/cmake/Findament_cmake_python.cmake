# SPDX-License-Identifier: Apache-2.0
#
# What the packages of this repository use of ament_cmake_python, for builds without it.

set(ament_cmake_python_FOUND TRUE)
find_package(Python3 REQUIRED COMPONENTS Interpreter)
set(PYTHON_INSTALL_DIR lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/site-packages
  CACHE STRING "Where Python packages are installed, below the prefix")

function(ament_python_install_package package)
  install(DIRECTORY ${package} DESTINATION ${PYTHON_INSTALL_DIR} PATTERN __pycache__ EXCLUDE)
endfunction()
