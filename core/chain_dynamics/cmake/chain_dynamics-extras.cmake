# SPDX-License-Identifier: Apache-2.0

# chain_dynamics_export_own_symbols(<target> [<pattern>...])
#
# The shared library <target> offers what is declared in the namespace of its name, and nothing else. Copies of inline
# functions and templates, Eigen's above all, stay its own: a program or library that was compiled with other flags has
# others of the same name, which the dynamic linker would otherwise put in their place (or the other way round), and
# memory that one of them allocated would be freed by the other. <pattern>: mangled names of other symbols to offer.
# Type information stays common, for exceptions and dynamic_cast.
function(chain_dynamics_export_own_symbols target)
  set_target_properties(${target} PROPERTIES VISIBILITY_INLINES_HIDDEN ON)
  if(APPLE OR WIN32)
    return() # whose linkers read no version scripts
  endif()
  set(script ${CMAKE_CURRENT_BINARY_DIR}/${target}.symbols)
  set(symbols "extern \"C++\" { ${target}::*; }; _ZT*;")
  foreach(pattern ${ARGN})
    string(APPEND symbols " ${pattern};")
  endforeach()
  file(WRITE ${script} "{ global: ${symbols} local: *; };\n")
  target_link_options(${target} PRIVATE LINKER:--version-script=${script})
  set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS ${script})
endfunction()

# chain_dynamics_add_library([<package>...] [SOURCES <further sources>...])
#
# The shared library ${PROJECT_NAME} of src/*.cpp but plugin.cpp, installed and exported with the headers below include/,
# and linked to the packages, which its users need too. It and all later targets are compiled with warnings. A macro,
# since ament keeps what a package exports in the variables of its CMakeLists.txt.
macro(chain_dynamics_add_library)
  cmake_parse_arguments(_library "" "" "SOURCES" ${ARGN})
  file(GLOB _sources CONFIGURE_DEPENDS src/*.cpp ${_library_SOURCES})
  list(FILTER _sources EXCLUDE REGEX "/plugin.cpp$")
  add_compile_options(-Wall -Wextra -Wpedantic -Wshadow)
  add_library(${PROJECT_NAME} SHARED ${_sources})
  target_compile_features(${PROJECT_NAME} PUBLIC cxx_std_17)
  chain_dynamics_export_own_symbols(${PROJECT_NAME})
  foreach(_package ${_library_UNPARSED_ARGUMENTS})
    target_link_libraries(${PROJECT_NAME} PUBLIC ${_package}::${_package})
  endforeach()
  chain_dynamics_export_library(${_library_UNPARSED_ARGUMENTS})
endmacro()

# chain_dynamics_export_library([<package>...])
#
# Installs and exports the library ${PROJECT_NAME}, whose users need the packages.
macro(chain_dynamics_export_library)
  target_include_directories(${PROJECT_NAME} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
    $<INSTALL_INTERFACE:include/${PROJECT_NAME}>)
  install(DIRECTORY include/ DESTINATION include/${PROJECT_NAME})
  install(TARGETS ${PROJECT_NAME} EXPORT export_${PROJECT_NAME}
    ARCHIVE DESTINATION lib LIBRARY DESTINATION lib RUNTIME DESTINATION bin)
  ament_export_targets(export_${PROJECT_NAME} HAS_LIBRARY_TARGET)
  ament_export_dependencies(${ARGN})
  # Before what the package depends on is looked for.
  list(INSERT ${PROJECT_NAME}_CONFIG_EXTRAS 0 ${chain_dynamics_extras}/ament_python-extras.cmake)
endmacro()
set(chain_dynamics_extras ${CMAKE_CURRENT_LIST_DIR})

# From 0.9 on yaml-cpp deprecates the target without a namespace, the only one before 0.8.
set(chain_dynamics_yaml_cpp $<IF:$<TARGET_EXISTS:yaml-cpp::yaml-cpp>,yaml-cpp::yaml-cpp,yaml-cpp>)
