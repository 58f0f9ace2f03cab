// SPDX-License-Identifier: Apache-2.0
#include <pybind11/pybind11.h>
#include <structmember.h>

#include <cstddef>

#include "bindings.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;

/// A function of pybind11 as Python has its own: with attributes, a signature, and errors that name
/// arguments.
struct Function {
  PyObject_HEAD vectorcallfunc call;
  PyObject* bound;       // pybind11's
  PyObject* attributes;  // a dictionary
};

py::object inArguments(const char* function, const py::handle& first, const py::handle& second) {
  return py::module_::import("inverse_dynamics.arguments").attr(function)(first, second);
}

extern "C" PyObject* callFunction(PyObject* self, PyObject* const* arguments, std::size_t count,
                                  PyObject* names) {
  PyObject* const bound = reinterpret_cast<Function*>(self)->bound;
  PyObject* const result = PyObject_Vectorcall(bound, arguments, count, names);
  if (result != nullptr || (PyErr_ExceptionMatches(PyExc_TypeError) == 0 &&
                            PyErr_ExceptionMatches(PyExc_RuntimeError) == 0)) {
    return result;
  }
  py::error_already_set error;  // takes the exception
  try {
    const py::object raise = inArguments("raiser", self, error.value());
    if (!raise.is_none()) return PyObject_Vectorcall(raise.ptr(), arguments, count, names);
    error.restore();
  } catch (py::error_already_set& raised) {
    raised.restore();
  }
  return nullptr;
}

extern "C" PyObject* bindToObject(PyObject* self, PyObject* object, PyObject* /*type*/) {
  return object == nullptr ? py::handle(self).inc_ref().ptr() : PyMethod_New(self, object);
}

py::object functionOf(const py::object& bound, const py::dict& attributes) {
  static PyMemberDef members[] = {
      {"__vectorcalloffset__", T_PYSSIZET, offsetof(Function, call), READONLY, nullptr},
      {"__dictoffset__", T_PYSSIZET, offsetof(Function, attributes), READONLY, nullptr},
      {}};
  static PyType_Slot slots[] = {{Py_tp_call, reinterpret_cast<void*>(&PyVectorcall_Call)},
                                {Py_tp_descr_get, reinterpret_cast<void*>(&bindToObject)},
                                {Py_tp_members, members},
                                {}};
  static PyType_Spec spec = {
      "inverse_dynamics._core.function", sizeof(Function), 0,
      Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_VECTORCALL | Py_TPFLAGS_METHOD_DESCRIPTOR, slots};
  static PyObject* const kType = PyType_FromSpec(&spec);
  if (kType == nullptr) throw py::error_already_set();
  auto* const made = PyObject_New(Function, reinterpret_cast<PyTypeObject*>(kType));
  made->call = &callFunction;
  made->bound = bound.inc_ref().ptr();
  made->attributes = attributes.inc_ref().ptr();
  return py::reinterpret_steal<py::object>(reinterpret_cast<PyObject*>(made));
}

// Called where pybind11 would allocate an object without constructing it.
void* refuseWithoutInit(std::size_t /*size*/) {
  throw py::type_error("an object without __init__; make it by calling its class");
}

}  // namespace

void explainWrongCalls(py::module_& module) {
  for (const auto& [name, value] : py::dict(module.attr("__dict__"))) {
    if (PyType_Check(value.ptr()) == 0) continue;
    auto* const type = reinterpret_cast<PyTypeObject*>(value.ptr());
    py::detail::get_type_info(type)->operator_new = &refuseWithoutInit;
  }
  inArguments("explain", module, py::cpp_function(&functionOf));
}

}  // namespace inverse_dynamics_tools
