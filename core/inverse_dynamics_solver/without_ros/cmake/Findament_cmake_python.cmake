# SPDX-License-Identifier: Apache-2.0
#
# What the packages of this repository use of ament_cmake_python, for builds without it.

set(ament_cmake_python_FOUND TRUE)
find_package(Python3 REQUIRED COMPONENTS Interpreter)
set(PYTHON_INSTALL_DIR lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/site-packages
  CACHE STRING "Where Python packages are installed, below the prefix")

function(ament_python_install_package package)
  install(DIRECTORY ${package} DESTINATION ${PYTHON_INSTALL_DIR} PATTERN __pycache__ EXCLUDE)
  if(SKBUILD) # pip notes the version
    return()
  endif()
  file(STRINGS ${PROJECT_SOURCE_DIR}/package.xml version REGEX "<version>")
  string(REGEX REPLACE ".*<version>(.*)</version>.*" "\\1" version "${version}")
  set(metadata ${package}-${version}.egg-info)
  file(WRITE ${PROJECT_BINARY_DIR}/${metadata}/PKG-INFO
    "Metadata-Version: 2.1\nName: ${package}\nVersion: ${version}\n")
  install(DIRECTORY ${PROJECT_BINARY_DIR}/${metadata} DESTINATION ${PYTHON_INSTALL_DIR})
endfunction()
