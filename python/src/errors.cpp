// SPDX-License-Identifier: Apache-2.0
#include <pybind11/pybind11.h>

#include <cctype>
#include <chain_dynamics/error.hpp>
#include <cstddef>
#include <cstring>
#include <exception>
#include <inverse_dynamics_evaluation/error.hpp>
#include <inverse_dynamics_evaluation/package_share.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <string>
#include <utility>

#include "bindings.hpp"
#include "description.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace ids = inverse_dynamics_solver;

/// Words of the C++ libraries, and their equivalents in Python.
constexpr std::pair<const char*, const char*> kWords[] = {
    {"pass a URDF to initialize() as third argument, or set the parameter 'robot_description' "
     "(without namespace) or 'model'",
     "give a URDF (urdf) or a model file (model)"},
    {"pass it to initialize() as third argument, or set the parameter 'robot_description' "
     "(without namespace)",
     "give a URDF (urdf)"},
    {"removePayload()", "remove_payload()"},
    {"call getFrictionVector(q, qd), in Python ", "call "},
    {"inertiaIsPhysical()", "inertia_is_physical"},
    {", or ask hasEnergies() first", ""},
};

/// `friction_vector: ...` of `getFrictionVectorBatch: ...`.
std::string withPythonsMethod(const std::string& text) {
  std::string method = text.substr(0, text.find_first_of(": "));
  for (const std::string verb : {"get", "set", "remove", "clear"}) {
    if (method.rfind(verb, 0) != 0 || std::isupper(method[verb.size()]) == 0) continue;
    const std::string rest = text.substr(method.size());
    const std::size_t batch = method.rfind("Batch");
    method = method.substr(0, batch).substr(verb == "get" ? verb.size() : 0);
    std::string snake;
    for (const char c : method) {
      if (std::isupper(c) != 0 && !snake.empty()) snake += '_';
      snake += static_cast<char>(std::tolower(c));
    }
    return (snake == "tip_jacobian" ? "jacobian" : snake) + rest;
  }
  return text;
}

std::string inPython(const std::string& of_cpp) {
  std::string text = withPythonsMethod(of_cpp);
  for (const auto& [cpp, python] : kWords) {
    const std::size_t at = text.find(cpp);
    if (at != std::string::npos) text.replace(at, std::strlen(cpp), python);
  }
  return text;
}

void setError(const char* name, const std::string& text) {
  const py::object type = py::module_::import("inverse_dynamics.errors").attr(name);
  PyErr_SetObject(type.ptr(), textOf(text).ptr());
}

/// Raises the exception of Python for one of C++, if it is of that class.
template <class Class>
bool raisedIf(const std::exception& error, const char* name) {
  if (dynamic_cast<const Class*>(&error) == nullptr) return false;
  setError(name, inPython(error.what()));
  return true;
}

void translate(std::exception_ptr thrown) {
  namespace evaluation = inverse_dynamics_evaluation;
  if (!thrown) return;
  try {
    std::rethrow_exception(thrown);
  } catch (const std::exception& e) {  // a class before those that it is derived from
    const bool known =
        raisedIf<ids::PluginNotFoundException>(e, "PluginNotFoundError") ||
        raisedIf<ids::ParameterUninitializedException>(e, "ParameterMissingError") ||
        raisedIf<ids::InvalidRobotDescriptionException>(e, "InvalidRobotDescriptionError") ||
        raisedIf<ids::InvalidParameterValueException>(e, "InvalidParameterError") ||
        raisedIf<ids::SizeMismatchException>(e, "SizeMismatchError") ||
        raisedIf<ids::Exception>(e, "SolverError") ||
        raisedIf<evaluation::EvaluationError>(e, "EvaluationError") ||
        raisedIf<evaluation::PackageNotFoundError>(e, "PackageNotFoundError") ||
        raisedIf<evaluation::ConfigurationError>(e, "RobotError") ||
        raisedIf<evaluation::RecordingError>(e, "BagError") ||
        raisedIf<chain_dynamics::ModelError>(e, "SolverError");
    if (!known) throw;
  }
}

}  // namespace

void throwError(const char* name, const std::string& text) {
  setError(name, text);
  throw py::error_already_set();
}

void bindErrors() { py::register_local_exception_translator(&translate); }

}  // namespace inverse_dynamics_tools
