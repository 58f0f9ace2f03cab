# SPDX-License-Identifier: Apache-2.0
#
# Pinocchio's headers, of any installation: ROS, the system, or the wheel `libpinocchio` of the Python in use.
# Its algorithms are templates, so no library is linked and none has to be found at run time.
#
# Result: PinocchioHeaders_FOUND and the target Pinocchio::headers.

find_package(Python3 QUIET COMPONENTS Interpreter)
if(Python3_Interpreter_FOUND)
  # Such wheels are installed below site-packages/cmeel.prefix.
  execute_process(
    COMMAND ${Python3_EXECUTABLE} -c "import sysconfig; print(sysconfig.get_path('purelib'))"
    OUTPUT_VARIABLE site_packages ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
set(hints ${site_packages}/cmeel.prefix/include)

find_path(PINOCCHIO_INCLUDE_DIR pinocchio/algorithm/rnea.hpp HINTS ${hints})
# A wheel brings the Boost it was made with.
find_path(PINOCCHIO_BOOST_INCLUDE_DIR boost/variant.hpp HINTS ${PINOCCHIO_INCLUDE_DIR})
find_package(Eigen3 QUIET NO_MODULE)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(PinocchioHeaders
  REQUIRED_VARS PINOCCHIO_INCLUDE_DIR PINOCCHIO_BOOST_INCLUDE_DIR Eigen3_FOUND)
mark_as_advanced(PINOCCHIO_INCLUDE_DIR PINOCCHIO_BOOST_INCLUDE_DIR)

if(PinocchioHeaders_FOUND AND NOT TARGET Pinocchio::headers)
  add_library(Pinocchio::headers INTERFACE IMPORTED)
  set_target_properties(Pinocchio::headers PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${PINOCCHIO_INCLUDE_DIR};${PINOCCHIO_BOOST_INCLUDE_DIR}"
    # Its lists of joint types and arguments are longer than Boost's are by default; it asks for joint types that a
    # collection of fewer doesn't have [pinocchio_headers.hpp].
    INTERFACE_COMPILE_DEFINITIONS "BOOST_MPL_CFG_NO_PREPROCESSED_HEADERS;BOOST_MPL_LIMIT_LIST_SIZE=30;BOOST_MPL_LIMIT_VECTOR_SIZE=30;BOOST_FUSION_INVOKE_MAX_ARITY=12;BOOST_VARIANT_USE_RELAXED_GET_BY_DEFAULT"
    # Of constructors that GCC 14 expands into their callers.
    INTERFACE_COMPILE_OPTIONS "$<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>"
    INTERFACE_LINK_LIBRARIES Eigen3::Eigen)
endif()
