# SPDX-License-Identifier: Apache-2.0

# Keeps a plugin library open once it has been: pluginlib's loader closes libraries when it is destroyed, and an exception
# that the plugin has thrown needs the plugin's code until it has been handled.
function(inverse_dynamics_solver_keep_open plugin_library)
  if(APPLE OR WIN32)
    return() # whose linkers know no such option; SolverLoader keeps what it opens
  endif()
  target_link_options(${plugin_library} PRIVATE LINKER:-z,nodelete)
endfunction()

# inverse_dynamics_solver_add_plugin([DEPENDENCIES <package>...])
#
# Makes the solver library ${PROJECT_NAME} a plugin, and installs and exports it with the headers below include/. If there
# is no such target, it is made of src/*.cpp, and offers the namespace of its name. The registration, src/plugin.cpp,
# becomes a library of its own, ${PROJECT_NAME}_plugin, that only pluginlib opens; ${PROJECT_NAME}.xml describes it.
# DEPENDENCIES: packages that users of the headers need, inverse_dynamics_solver by default. A macro, since ament keeps
# what a package exports in the variables of its CMakeLists.txt.
macro(inverse_dynamics_solver_add_plugin)
  cmake_parse_arguments(_solver "" "" "DEPENDENCIES" ${ARGN})
  if(NOT _solver_DEPENDENCIES)
    set(_solver_DEPENDENCIES inverse_dynamics_solver)
  endif()
  if(TARGET ${PROJECT_NAME})
    chain_dynamics_export_library(${_solver_DEPENDENCIES})
  else()
    chain_dynamics_add_library(${_solver_DEPENDENCIES})
  endif()
  list(APPEND ${PROJECT_NAME}_CONFIG_EXTRAS ${chain_dynamics_extras}/ament_headers-extras.cmake)

  if(NOT TARGET pluginlib::pluginlib)
    find_package(pluginlib REQUIRED)
  endif()
  add_library(${PROJECT_NAME}_plugin SHARED src/plugin.cpp)
  target_link_libraries(${PROJECT_NAME}_plugin PRIVATE ${PROJECT_NAME} pluginlib::pluginlib)
  inverse_dynamics_solver_keep_open(${PROJECT_NAME}_plugin)
  # It finds the solver library beside it, wherever the two are installed.
  set_target_properties(${PROJECT_NAME}_plugin PROPERTIES
    INSTALL_RPATH "$<IF:$<PLATFORM_ID:Darwin>,@loader_path,$ORIGIN>")
  pluginlib_export_plugin_description_file(inverse_dynamics_solver ${PROJECT_NAME}.xml)
  install(TARGETS ${PROJECT_NAME}_plugin LIBRARY DESTINATION lib RUNTIME DESTINATION bin)
  if(IS_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/launch)
    install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})
  endif()
endmacro()

# inverse_dynamics_solver_link_conformance_tests(<test>)
#
# Links a test that instantiates the conformance tests with their library: the one that was built with the interface,
# where it was built with its tests, by the same compiler and with the same flags; else one of this project's own.
function(inverse_dynamics_solver_link_conformance_tests test)
  set(library inverse_dynamics_solver::conformance_tests)
  if(TARGET ${library})
    get_target_property(built_by ${library} BUILT_BY)
  endif()
  if(NOT built_by STREQUAL "${CMAKE_CXX_COMPILER} ${CMAKE_CXX_FLAGS}")
    set(library ${PROJECT_NAME}_conformance_tests)
    if(NOT TARGET ${library})
      ament_find_gtest()
      add_library(${library} STATIC EXCLUDE_FROM_ALL
        ${inverse_dynamics_solver_DIR}/../conformance_tests.cpp)
      target_include_directories(${library} SYSTEM PRIVATE ${GTEST_INCLUDE_DIRS})
      target_link_libraries(${library} PUBLIC inverse_dynamics_solver::inverse_dynamics_solver)
    endif()
  endif()
  target_link_libraries(${test} ${library})
endfunction()

# inverse_dynamics_solver_add_plugin_test(<test> <source>... PLUGIN <target> [DESCRIPTION <file>]
#                                         [TIMEOUT <seconds>])
#
# A GoogleTest program that loads the plugin library <target> by name before it is installed: the plugin
# description (default <project>.xml) and the library are laid out in the build folder as an installation, and
# AMENT_PREFIX_PATH of the test begins there. Call it after find_package(ament_cmake_gtest).
function(inverse_dynamics_solver_add_plugin_test test)
  cmake_parse_arguments(ARG "" "PLUGIN;DESCRIPTION;TIMEOUT" "" ${ARGN})
  if(NOT ARG_PLUGIN)
    message(FATAL_ERROR "inverse_dynamics_solver_add_plugin_test(${test}): PLUGIN is missing")
  endif()
  if(NOT ARG_DESCRIPTION)
    set(ARG_DESCRIPTION ${PROJECT_NAME}.xml)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 600)
  endif()

  # Once per package, however many tests load its plugin.
  set(prefix
    "${CMAKE_CURRENT_BINARY_DIR}/pluginlib_enable_plugin_testing/install/${PROJECT_NAME}__inverse_dynamics_solver")
  if(NOT TARGET pluginlib_enable_plugin_testing__inverse_dynamics_solver__${PROJECT_NAME})
    find_package(pluginlib REQUIRED)
    pluginlib_enable_plugin_testing(
      CMAKE_TARGET_VAR mock_install
      AMENT_PREFIX_PATH_VAR prefix
      PLUGIN_CATEGORY inverse_dynamics_solver
      PLUGIN_DESCRIPTIONS ${ARG_DESCRIPTION}
      PLUGIN_LIBRARIES ${ARG_PLUGIN})
  endif()

  # Before everything else, so that an older installation isn't what gets tested.
  set(prefixes "${prefix}")
  if(NOT "$ENV{AMENT_PREFIX_PATH}" STREQUAL "")
    string(APPEND prefixes ":$ENV{AMENT_PREFIX_PATH}")
  endif()
  ament_add_gtest(${test} ${ARG_UNPARSED_ARGUMENTS}
    TIMEOUT ${ARG_TIMEOUT} ENV "AMENT_PREFIX_PATH=${prefixes}")
  target_link_libraries(${test} inverse_dynamics_solver::inverse_dynamics_solver)
  add_dependencies(${test} ${ARG_PLUGIN})
endfunction()

# inverse_dynamics_solver_add_solver_test([<further source>...])
#
# The program ${PROJECT_NAME}_test of the conformance tests and the solver's own, which load the plugin.
macro(inverse_dynamics_solver_add_solver_test)
  find_package(ament_cmake_gtest REQUIRED)
  find_package(yaml-cpp REQUIRED)
  inverse_dynamics_solver_add_plugin_test(${PROJECT_NAME}_test
    test/conformance_test.cpp test/${PROJECT_NAME}_test.cpp ${ARGN} PLUGIN ${PROJECT_NAME}_plugin)
  target_link_libraries(${PROJECT_NAME}_test ${PROJECT_NAME} ${chain_dynamics_yaml_cpp})
  inverse_dynamics_solver_link_conformance_tests(${PROJECT_NAME}_test)
endmacro()

# Builds a test program with RealtimeSanitizer where the compiler has it: Clang from version 20 on.
function(inverse_dynamics_solver_watch_real_time target)
  include(CheckCXXSourceCompiles)
  set(CMAKE_REQUIRED_FLAGS -fsanitize=realtime)
  check_cxx_source_compiles("int main() {}" INVERSE_DYNAMICS_SOLVER_HAS_REALTIME_SANITIZER)
  if(INVERSE_DYNAMICS_SOLVER_HAS_REALTIME_SANITIZER)
    target_compile_options(${target} PRIVATE -fsanitize=realtime)
    target_link_options(${target} PRIVATE -fsanitize=realtime)
  endif()
endfunction()
