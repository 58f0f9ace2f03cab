# SPDX-License-Identifier: Apache-2.0

# The reference implementation is released under some names of this workspace. Where such a release lies in an underlay,
# a directory that other packages bring (/opt/ros/DISTRO/include) may hold its headers: then those of this package are
# put before all directories of the targets that are made after find_package().
get_filename_component(_share "${CMAKE_CURRENT_LIST_DIR}" DIRECTORY)
get_filename_component(_package "${_share}" NAME)
get_filename_component(_own_prefix "${_share}/../.." REALPATH)
set(_own_headers "${_own_prefix}/include/${_package}")
string(REPLACE ":" ";" _prefixes "$ENV{AMENT_PREFIX_PATH}:$ENV{CMAKE_PREFIX_PATH}")
foreach(_prefix IN LISTS CMAKE_PREFIX_PATH _prefixes)
  get_filename_component(_prefix "${_prefix}" REALPATH)
  if(_prefix STREQUAL _own_prefix)
    continue() # an earlier build may have left headers there
  endif()
  if(EXISTS "${_prefix}/include/${_package}/${_package}.hpp" OR EXISTS "${_prefix}/include/${_package}/${_package}.h")
    message(NOTICE "${_prefix}/include has headers of another ${_package}: ${_own_headers} comes before it")
    # Directories of imported targets count as those of the system, which come last.
    set(CMAKE_NO_SYSTEM_FROM_IMPORTED ON)
    include_directories(BEFORE "${_own_headers}")
    break()
  endif()
endforeach()
