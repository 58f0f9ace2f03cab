// SPDX-License-Identifier: Apache-2.0
#include <pybind11/pybind11.h>
#include <structmember.h>

#include <cstddef>
#include <string>

#include "bindings.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;

/// A bound function or method as Python has it: with a signature, and errors that name arguments.
struct Function {
  PyObject_HEAD vectorcallfunc call;
  PyObject* bound;  // pybind11's, whose docstring begins with the signature
  PyObject* name;   // torques
  PyObject* place;  // Solver.torques
};

const Function& functionAt(PyObject* self) { return *reinterpret_cast<Function*>(self); }

py::object inArguments(const char* function) {
  return py::module_::import("inverse_dynamics.arguments").attr(function);
}

py::str docOf(const Function& function) { return py::handle(function.bound).attr("__doc__"); }

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

/// The exception for a call, made by inverse_dynamics.arguments from the function's signature.
void raiseRefusal(const Function& function, PyObject* const* arguments, Py_ssize_t count,
                  PyObject* names) {
  py::list positional;
  for (Py_ssize_t i = 0; i < count; ++i) positional.append(py::handle(arguments[i]));
  py::dict named;
  for (Py_ssize_t i = 0; names != nullptr && i < PyTuple_GET_SIZE(names); ++i) {
    named[py::handle(PyTuple_GET_ITEM(names, i))] = py::handle(arguments[count + i]);
  }
  const py::object error =
      inArguments("refused")(py::handle(function.place), docOf(function), positional, named);
  PyErr_SetObject(py::type::handle_of(error).ptr(), error.ptr());
}

/// Returns made(), or null if it raises.
template <class Make>
PyObject* orRaised(const Make& made) {
  try {
    return made().release().ptr();
  } catch (py::error_already_set& error) {
    error.restore();
    return nullptr;
  }
}

extern "C" PyObject* callFunction(PyObject* self, PyObject* const* arguments, std::size_t count,
                                  PyObject* names) {
  const Function& function = functionAt(self);
  PyObject* const result = PyObject_Vectorcall(function.bound, arguments, count, names);
  if (result != nullptr) return result;
  return orRaised([&] {
    if (refusesArguments()) {
      PyErr_Clear();
      raiseRefusal(function, arguments, PyVectorcall_NARGS(count), names);
    }
    return py::object();
  });
}

extern "C" PyObject* bindToObject(PyObject* self, PyObject* object, PyObject* /*type*/) {
  if (object != nullptr && object != Py_None) return PyMethod_New(self, object);
  Py_INCREF(self);
  return self;
}

extern "C" PyObject* signatureOfFunction(PyObject* self, void* /*unused*/) {
  return orRaised([&] { return inArguments("signature_of")(docOf(functionAt(self))); });
}

extern "C" PyObject* textOfFunction(PyObject* self, void* /*unused*/) {
  return orRaised(
      [&] { return py::object(docOf(functionAt(self)).attr("partition")("\n\n")[py::int_(2)]); });
}

/// The class of Function. Its objects are as old as the module.
py::handle functionType() {
  static PyMemberDef members[] = {
      {"__vectorcalloffset__", T_PYSSIZET, offsetof(Function, call), READONLY, nullptr},
      {"__name__", T_OBJECT, offsetof(Function, name), READONLY, nullptr},
      {"__qualname__", T_OBJECT, offsetof(Function, place), READONLY, nullptr},
      {}};
  static PyGetSetDef properties[] = {
      {"__signature__", &signatureOfFunction, nullptr, nullptr, nullptr},
      {"__doc__", &textOfFunction, nullptr, nullptr, nullptr},
      {}};
  static PyType_Slot slots[] = {{Py_tp_call, reinterpret_cast<void*>(&PyVectorcall_Call)},
                                {Py_tp_descr_get, reinterpret_cast<void*>(&bindToObject)},
                                {Py_tp_members, members},
                                {Py_tp_getset, properties},
                                {}};
  static PyType_Spec spec = {
      "inverse_dynamics._core.function", sizeof(Function), 0,
      Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_VECTORCALL | Py_TPFLAGS_METHOD_DESCRIPTOR, slots};
  static PyObject* const kType = PyType_FromSpec(&spec);
  if (kType == nullptr) throw py::error_already_set();
  return kType;
}

py::object explained(const py::object& bound, const std::string& place) {
  auto* const function =
      PyObject_New(Function, reinterpret_cast<PyTypeObject*>(functionType().ptr()));
  function->call = &callFunction;
  function->bound = py::object(bound).release().ptr();
  function->name = py::str(place.substr(place.rfind('.') + 1)).release().ptr();
  function->place = py::str(place).release().ptr();
  return py::reinterpret_steal<py::object>(reinterpret_cast<PyObject*>(function));
}

// Called where pybind11 would allocate an object without constructing it.
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
    py::setattr(type, name.c_str(),
                is_static ? py::reinterpret_steal<py::object>(PyStaticMethod_New(function.ptr()))
                          : function);
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
