# SPDX-License-Identifier: Apache-2.0
#
# For the functions that this installation offers to packages of users, such as inverse_dynamics_solver_add_plugin():
# what they, and the packages themselves, use of ament and pluginlib. A project that has found ament keeps it.

if(NOT COMMAND ament_package)
  list(APPEND CMAKE_MODULE_PATH ${CMAKE_CURRENT_LIST_DIR})
  include(${CMAKE_CURRENT_LIST_DIR}/Findament_cmake.cmake)
endif()
if(NOT TARGET pluginlib::pluginlib)
  include(${CMAKE_CURRENT_LIST_DIR}/Findpluginlib.cmake)
endif()
