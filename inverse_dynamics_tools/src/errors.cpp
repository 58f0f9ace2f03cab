// SPDX-License-Identifier: Apache-2.0
#include <pybind11/pybind11.h>

#include <chain_dynamics/error.hpp>
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

/// What the libraries say to users of C++, and what Python has for it.
constexpr std::pair<const char*, const char*> kWords[] = {
    {"pass a URDF to initialize() as third argument, or set the parameter 'robot_description' "
     "(without namespace) or 'model'",
     "give a URDF (urdf) or a model file (model)"},
    {"pass it to initialize() as third argument, or set the parameter 'robot_description' "
     "(without namespace)",
     "give a URDF (urdf)"},
    {"setPayload: ", "set_payload: "},
    {"removePayload()", "remove_payload()"},
    {"setGravity: ", "set_gravity: "},
    {"setBaseAcceleration: ", "set_base_acceleration: "},
};

std::string inPython(std::string text) {
  for (const auto& [cpp, python] : kWords) {
    const std::size_t at = text.find(cpp);
    if (at != std::string::npos) text.replace(at, std::strlen(cpp), python);
  }
  return text;
}

void raise(const char* class_name, const std::exception& error) {
  const py::object type = py::module_::import("inverse_dynamics.errors").attr(class_name);
  PyErr_SetObject(type.ptr(), textOf(inPython(error.what())).ptr());
}

void translate(std::exception_ptr thrown) {
  if (!thrown) return;
  try {
    std::rethrow_exception(thrown);
  } catch (const ids::PluginNotFoundException& e) {
    raise("PluginNotFoundError", e);
  } catch (const ids::ParameterUninitializedException& e) {
    raise("ParameterMissingError", e);
  } catch (const ids::InvalidRobotDescriptionException& e) {
    raise("InvalidRobotDescriptionError", e);
  } catch (const ids::InvalidParameterValueException& e) {
    raise("InvalidParameterError", e);
  } catch (const ids::SizeMismatchException& e) {
    raise("SizeMismatchError", e);
  } catch (const ids::Exception& e) {
    raise("SolverError", e);
  } catch (const inverse_dynamics_evaluation::EvaluationError& e) {
    raise("EvaluationError", e);
  } catch (const inverse_dynamics_evaluation::PackageNotFoundError& e) {
    raise("PackageNotFoundError", e);
  } catch (const inverse_dynamics_evaluation::ConfigurationError& e) {
    raise("RobotError", e);
  } catch (const inverse_dynamics_evaluation::RecordingError& e) {
    raise("BagError", e);
  } catch (const chain_dynamics::ModelError& e) {
    raise("SolverError", e);
  }
}

}  // namespace

void throwArgumentError(const std::string& text) {
  const py::object type = py::module_::import("inverse_dynamics.errors").attr("ArgumentError");
  PyErr_SetString(type.ptr(), text.c_str());
  throw py::error_already_set();
}

void bindErrors() { py::register_local_exception_translator(&translate); }

}  // namespace inverse_dynamics_tools
