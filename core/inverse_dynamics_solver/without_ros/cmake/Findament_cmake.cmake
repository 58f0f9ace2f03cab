# SPDX-License-Identifier: Apache-2.0
#
# What the packages of this repository use of ament_cmake, for builds without it: a package's targets, its CMake
# configuration and its entry in the ament index are installed to where ament would have them found. In the folder
# ${build_prefix}, if that is set, the same entries describe the packages that aren't installed yet.

if(COMMAND ament_package AND NOT COMMAND inverse_dynamics_index_entry)
  message(FATAL_ERROR "This project has found ament_cmake, which the CMake project inverse_dynamics replaces: build the "
    "packages with colcon, or add inverse_dynamics in a project without ament.")
endif()
set(ament_cmake_FOUND TRUE)

function(ament_export_targets export)
  install(EXPORT ${export} NAMESPACE ${PROJECT_NAME}:: FILE ${PROJECT_NAME}Targets.cmake
    DESTINATION lib/cmake/${PROJECT_NAME})
endfunction()

function(ament_export_dependencies)
  set_property(DIRECTORY APPEND PROPERTY exported_dependencies ${ARGN})
endfunction()

# inverse_dynamics_index_entry(<resource> <content>)
function(inverse_dynamics_index_entry resource content)
  set(entry share/ament_index/resource_index/${resource}/${PROJECT_NAME})
  file(WRITE ${PROJECT_BINARY_DIR}/prefix/${entry} "${content}")
  if(build_prefix)
    file(WRITE ${build_prefix}/${entry} "${content}")
  endif()
  install(FILES ${PROJECT_BINARY_DIR}/prefix/${entry} DESTINATION share/ament_index/resource_index/${resource})
endfunction()

function(ament_package)
  cmake_parse_arguments(ARG "" "" "CONFIG_EXTRAS" ${ARGN})
  list(FILTER ARG_CONFIG_EXTRAS EXCLUDE REGEX "ament_(headers|python)-extras.cmake$") # of use to ament only
  list(TRANSFORM ARG_CONFIG_EXTRAS REPLACE ".*/" "" OUTPUT_VARIABLE names)
  set(config ${PROJECT_NAME}Config.cmake)
  get_directory_property(dependencies exported_dependencies)
  inverse_dynamics_index_entry(packages "")
  install(FILES package.xml DESTINATION share/${PROJECT_NAME})

  # For packages in the same build.
  if(TARGET ${PROJECT_NAME} AND NOT TARGET ${PROJECT_NAME}::${PROJECT_NAME})
    add_library(${PROJECT_NAME}::${PROJECT_NAME} ALIAS ${PROJECT_NAME})
  endif()
  if(build_prefix)
    file(CREATE_LINK ${PROJECT_SOURCE_DIR} ${build_prefix}/share/${PROJECT_NAME} SYMBOLIC)
    list(TRANSFORM dependencies REPLACE "(.+)" "find_package(\\1 REQUIRED)\n" OUTPUT_VARIABLE finds)
    list(TRANSFORM ARG_CONFIG_EXTRAS REPLACE "(.+)" "include(\"${PROJECT_SOURCE_DIR}/\\1\")\n" OUTPUT_VARIABLE includes)
    file(WRITE ${${PROJECT_NAME}_DIR}/${config} ${finds} ${includes})
  endif()

  # For users of the installation.
  set(here "\${CMAKE_CURRENT_LIST_DIR}")
  set(text "include(CMakeFindDependencyMacro)\n")
  foreach(dependency IN LISTS dependencies)
    string(APPEND text "find_dependency(${dependency} HINTS \"${here}/../../..\")\n")
  endforeach()
  string(APPEND text "include(\"${here}/${PROJECT_NAME}Targets.cmake\" OPTIONAL)\n")
  if(names) # functions for packages of users, which need what is here
    string(APPEND text "include(\"${here}/../inverse_dynamics/cmake/packages_of_users.cmake\")\n")
    list(TRANSFORM names REPLACE "(.+)" "include(\"${here}/\\1\")\n" OUTPUT_VARIABLE includes)
    string(APPEND text ${includes})
  endif()
  file(WRITE ${PROJECT_BINARY_DIR}/${config} "${text}")
  install(FILES ${PROJECT_BINARY_DIR}/${config} ${ARG_CONFIG_EXTRAS} DESTINATION lib/cmake/${PROJECT_NAME})
endfunction()
