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
