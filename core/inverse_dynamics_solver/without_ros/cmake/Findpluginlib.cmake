# SPDX-License-Identifier: Apache-2.0
#
# What the packages of this repository use of pluginlib, for builds without it.

set(pluginlib_FOUND TRUE)
if(NOT TARGET pluginlib::pluginlib)
  find_package(tinyxml2 QUIET) # of use to class_loader.hpp only, and chain_dynamics requires it
  add_library(pluginlib::pluginlib INTERFACE IMPORTED GLOBAL)
  target_include_directories(pluginlib::pluginlib INTERFACE ${CMAKE_CURRENT_LIST_DIR}/../include)
  target_compile_definitions(pluginlib::pluginlib INTERFACE INVERSE_DYNAMICS_WITHOUT_ROS)
  target_link_libraries(pluginlib::pluginlib INTERFACE
    $<TARGET_NAME_IF_EXISTS:tinyxml2::tinyxml2> ${CMAKE_DL_LIBS})
endif()

function(pluginlib_export_plugin_description_file category file)
  install(FILES ${file} DESTINATION share/${PROJECT_NAME})
  inverse_dynamics_index_entry(${category}__pluginlib__plugin "share/${PROJECT_NAME}/${file}\n")
endfunction()
