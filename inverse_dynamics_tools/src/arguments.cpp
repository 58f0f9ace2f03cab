// SPDX-License-Identifier: Apache-2.0
#include <deque>
#include <string>

#include "bindings.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;

/// A bound function, with what Python keeps pointers to.
struct Explained {
  py::object function;
  std::string name, doc;  // Solver.torques
  PyMethodDef definition;
};

/// Whether the current exception is pybind11's own about arguments.
bool refusesArguments() {
  const bool type_error = PyErr_ExceptionMatches(PyExc_TypeError) != 0;
  if (!type_error && PyErr_ExceptionMatches(PyExc_RuntimeError) == 0) return false;
  py::error_already_set error;  // takes the exception
  const std::string text = py::str(error.value());
  error.restore();
  return type_error ? text.find("): incompatible ") != std::string::npos
                    : text.rfind("Unable to cast Python instance", 0) == 0;
}

/// The exception for a call, made by inverse_dynamics.base.arguments from the function's signature.
void raiseRefusal(const Explained& explained, PyObject* const* arguments, Py_ssize_t count,
                  PyObject* names) {
  py::list positional;
  for (Py_ssize_t i = 0; i < count; ++i) positional.append(py::handle(arguments[i]));
  py::dict named;
  for (Py_ssize_t i = 0; names != nullptr && i < PyTuple_GET_SIZE(names); ++i) {
    named[py::handle(PyTuple_GET_ITEM(names, i))] = py::handle(arguments[count + i]);
  }
  const py::object refused = py::module_::import("inverse_dynamics.base.arguments").attr("refused");
  const py::object error = refused(explained.name, explained.doc, positional, named);
  PyErr_SetObject(py::type::handle_of(error).ptr(), error.ptr());
}

extern "C" PyObject* callExplained(PyObject* self, PyObject* const* arguments, Py_ssize_t count,
                                   PyObject* names) {
  const auto& explained = *static_cast<Explained*>(PyCapsule_GetPointer(self, nullptr));
  const auto size = static_cast<std::size_t>(count);
  PyObject* const result = PyObject_Vectorcall(explained.function.ptr(), arguments, size, names);
  try {
    if (result == nullptr && refusesArguments()) {
      PyErr_Clear();
      raiseRefusal(explained, arguments, count, names);
    }
  } catch (py::error_already_set& error) {
    error.restore();
  }
  return result;
}

py::object explained(const py::object& function, const std::string& name) {
  static auto& all = *new std::deque<Explained>;  // as long as the module: to the end
  const std::string doc = py::str(function.attr("__doc__"));
  Explained& one = all.emplace_back(Explained{function, name, doc, {}});
  const std::size_t point = name.rfind('.');
  one.definition = {one.name.c_str() + (point == std::string::npos ? 0 : point + 1),
                    reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(&callExplained)),
                    METH_FASTCALL | METH_KEYWORDS, one.doc.c_str()};
  const py::capsule self(static_cast<const void*>(&one));
  const auto module = py::str("inverse_dynamics._core");
  return py::reinterpret_steal<py::object>(
      PyCFunction_NewEx(&one.definition, self.ptr(), module.ptr()));
}

// Instead of memory for an object that isn't there.
void* refuseWithoutInit(std::size_t /*size*/) {
  throw py::type_error("an object without __init__; make it by calling its class");
}

void explainMethods(const py::object& type) {
  auto* const python_type = reinterpret_cast<PyTypeObject*>(type.ptr());
  py::detail::get_type_info(python_type)->operator_new = &refuseWithoutInit;
  const std::string owner = py::str(type.attr("__name__"));
  const py::dict members(type.attr("__dict__"));
  for (const auto& [key, value] : members) {
    const std::string name = py::str(key);
    if (name[0] == '_' && name != "__init__") continue;
    const bool is_static = PyObject_TypeCheck(value.ptr(), &PyStaticMethod_Type) != 0;
    if (!is_static && PyInstanceMethod_Check(value.ptr()) == 0) continue;
    const py::object function = explained(value.attr("__func__"), owner + "." + name);
    py::setattr(
        type, name.c_str(),
        py::reinterpret_steal<py::object>(is_static ? PyStaticMethod_New(function.ptr())
                                                    : PyInstanceMethod_New(function.ptr())));
  }
}

}  // namespace

void explainWrongCalls(py::module_& module) {
  const py::dict members(module.attr("__dict__"));
  const py::dict copy = members.attr("copy")();
  for (const auto& [key, value] : copy) {
    const std::string name = py::str(key);
    if (name[0] == '_') continue;
    if (PyType_Check(value.ptr()) != 0) {
      explainMethods(py::reinterpret_borrow<py::object>(value));
    } else if (PyCFunction_Check(value.ptr()) != 0) {
      module.attr(name.c_str()) = explained(py::reinterpret_borrow<py::object>(value), name);
    }
  }
}

}  // namespace inverse_dynamics_tools
