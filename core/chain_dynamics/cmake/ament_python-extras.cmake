# SPDX-License-Identifier: Apache-2.0

# ament's CMake files run the first python3 on PATH, and stop where it has no module ament_package (pyenv, conda, a
# virtual environment). Then the system's is taken, if it has. What the user has chosen stays: Python3_EXECUTABLE,
# Python3_ROOT_DIR, or an interpreter that was found before.
if(NOT TARGET Python3::Interpreter AND NOT Python3_EXECUTABLE AND NOT Python3_ROOT_DIR)
  find_program(_first_python3 python3)
  foreach(_python3 "${_first_python3}" /usr/bin/python3)
    execute_process(COMMAND "${_python3}" -c "import ament_package" RESULT_VARIABLE _failed OUTPUT_QUIET ERROR_QUIET)
    if("${_failed}" STREQUAL "0")
      if(NOT _python3 STREQUAL _first_python3)
        message(STATUS "${_first_python3} has no module ament_package: taking ${_python3}")
        set(Python3_EXECUTABLE "${_python3}")
      endif()
      break()
    endif()
  endforeach()
  unset(_first_python3 CACHE)
  unset(_failed)
endif()
