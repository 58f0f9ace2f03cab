# SPDX-License-Identifier: Apache-2.0
#
# What the packages of this repository use of ament_index_cpp, for builds without it.

set(ament_index_cpp_FOUND TRUE)
if(NOT TARGET ament_index_cpp::ament_index_cpp)
  add_library(ament_index_cpp::ament_index_cpp INTERFACE IMPORTED GLOBAL)
  target_include_directories(ament_index_cpp::ament_index_cpp INTERFACE ${CMAKE_CURRENT_LIST_DIR}/../include)
  target_link_libraries(ament_index_cpp::ament_index_cpp INTERFACE ${CMAKE_DL_LIBS})
endif()
