// SPDX-License-Identifier: Apache-2.0
/// @file
/// Python objects named as in annotations: signatures of bound functions state the types of their
/// arguments, and the stubs of the module are generated from signatures.
#pragma once

#include <pybind11/numpy.h>

#include <cstddef>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace inverse_dynamics_tools {

inline int isAnything(PyObject* /*object*/) { return 1; }

// NOLINTBEGIN(bugprone-macro-parentheses): the name of a class takes none
/// Anything; `annotation` is its type in signatures. The callee checks it.
#define INVERSE_DYNAMICS_TOOLS_OBJECT(Name, annotation)   \
  namespace inverse_dynamics_tools {                      \
  class Name : public pybind11::object {                  \
   public:                                                \
    PYBIND11_OBJECT_DEFAULT(Name, object, isAnything)     \
  };                                                      \
  }                                                       \
  namespace pybind11::detail {                            \
  template <>                                             \
  struct handle_type_name<inverse_dynamics_tools::Name> { \
    static constexpr auto name = const_name(annotation);  \
  };                                                      \
  }
// NOLINTEND(bugprone-macro-parentheses)

}  // namespace inverse_dynamics_tools

INVERSE_DYNAMICS_TOOLS_OBJECT(ArrayLike, "numpy.typing.ArrayLike")
INVERSE_DYNAMICS_TOOLS_OBJECT(MaybeArrayLike, "numpy.typing.ArrayLike | None")
INVERSE_DYNAMICS_TOOLS_OBJECT(Floats, "numpy.typing.NDArray[numpy.float64]")
INVERSE_DYNAMICS_TOOLS_OBJECT(MaybeFloats, "numpy.typing.NDArray[numpy.float64] | None")
INVERSE_DYNAMICS_TOOLS_OBJECT(FloatOrFloats, "numpy.float64 | numpy.typing.NDArray[numpy.float64]")
INVERSE_DYNAMICS_TOOLS_OBJECT(NameTuple, "tuple[str, ...]")
INVERSE_DYNAMICS_TOOLS_OBJECT(NumberTuple, "tuple[float, ...]")
INVERSE_DYNAMICS_TOOLS_OBJECT(Numbers3OrNone, "tuple[float, float, float] | None")
INVERSE_DYNAMICS_TOOLS_OBJECT(NumbersByName, "dict[str, float]")
INVERSE_DYNAMICS_TOOLS_OBJECT(ParameterDict, "dict[str, typing.Any]")
INVERSE_DYNAMICS_TOOLS_OBJECT(StorageName, "typing.Literal['sqlite3', 'mcap']")
INVERSE_DYNAMICS_TOOLS_OBJECT(ClockName, "typing.Literal['header', 'receive']")
INVERSE_DYNAMICS_TOOLS_OBJECT(FilePath, "pathlib.Path")
INVERSE_DYNAMICS_TOOLS_OBJECT(MaybeFilePath, "pathlib.Path | None")
INVERSE_DYNAMICS_TOOLS_OBJECT(SolverObject, "inverse_dynamics._core.Solver")

namespace inverse_dynamics_tools {

using TwoFloats = std::tuple<Floats, Floats>;
using ThreeFloats = std::tuple<Floats, Floats, Floats>;

inline NameTuple tupleOf(const std::vector<std::string>& names) {
  pybind11::tuple tuple(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) tuple[i] = pybind11::str(names[i]);
  return NameTuple(std::move(tuple));
}

}  // namespace inverse_dynamics_tools
